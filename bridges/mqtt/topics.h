#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/mqtt/broker.h"
#include "bridges/process/plant_change.h"
#include "config/model.h"

namespace mqtt {

/// Topics of one drive, written out once.
struct DriveTopics {
  std::string root;  ///< What the others begin with, without a slash.
  std::string status;
  std::string state;
  std::string control;
  std::string sdo_response;
  std::array<std::string, alarms::kAlarmKinds.size()> alarms;  ///< By AlarmKind.
  std::vector<std::string> signals;                            ///< By SignalId.
};

/// What a message is about, by its topic. Nothing in it is checked to exist.
struct Route {
  /// `alarm`, `status`: of ours, where somebody else may have written. `life`: where another gateway of our name shows.
  enum class Kind : std::uint8_t { set_signal, set_drive, nmt, sdo, alive, stop_all, alarm, status, life };
  Kind kind = Kind::set_signal;
  std::string_view drive;   ///< A part of the topic; empty: all, or the gateway itself.
  std::string_view signal;  ///< Of set_signal.
};

/// Every topic of a gateway, `B` being `<base>/<gateway>`. Those of drives and buses change with the plant; all else
/// stays what it is.
class Topics {
 public:
  Topics(const config::Model& model, const config::Mqtt& settings, std::string_view gateway);

  /// The plant changed. Topics of drives and buses that stay are where they were in memory.
  void change(const config::Model& model, const process::PlantChange& change);

  [[nodiscard]] const std::string& status() const noexcept { return status_; }
  [[nodiscard]] const std::string& health() const noexcept { return health_; }
  [[nodiscard]] const std::string& info() const noexcept { return info_; }
  /// Where the broker keeps below which prefixes Home Assistant was told of drives.
  [[nodiscard]] const std::string& home_assistant() const noexcept { return home_assistant_; }
  [[nodiscard]] const std::string& result() const noexcept { return result_; }
  [[nodiscard]] const std::string& root() const noexcept { return root_; }  ///< `B` itself.
  /// The gateway's name.
  [[nodiscard]] std::string_view gateway() const { return std::string_view(root_).substr(base_.size() + 1); }
  [[nodiscard]] const DriveTopics& drive(std::size_t index) const { return *drives_.at(index); }
  /// The list of active alarms.
  [[nodiscard]] const std::string& alarms() const noexcept { return alarms_; }
  [[nodiscard]] const std::string& bus_alarm(std::size_t bus) const { return *bus_alarms_.at(bus); }

  /// What commands come by, of any drive name: unknown ones are answered too.
  [[nodiscard]] std::vector<Subscription> command_subscriptions() const;
  /// Everything below `B`, to look through what the broker keeps. It overlaps with all others.
  [[nodiscard]] Subscription tree_subscription() const;
  /// Topics of alarms and statuses, where nobody but we should write.
  [[nodiscard]] std::vector<Subscription> watched_subscriptions() const;
  /// What stands behind `B/`; empty where the topic is none of ours.
  [[nodiscard]] std::string_view below_root(std::string_view topic) const;
  /// Of a topic that one of these subscriptions matches. On any thread.
  [[nodiscard]] std::optional<Route> route(std::string_view topic) const;
  /// No answer goes there: it lies below `base`, where it could be taken for a command or for something that a gateway
  /// publishes; or outside of `answers`; or nobody can publish to it.
  [[nodiscard]] bool refused_as_response(std::string_view topic) const;

 private:
  std::string base_;
  std::optional<std::vector<std::string>> answers_;
  std::string root_;
  std::string status_;
  std::string health_;
  std::string info_;
  std::string home_assistant_;
  std::string result_;
  std::string alarms_;
  std::vector<std::unique_ptr<const DriveTopics>> drives_;
  std::vector<std::unique_ptr<const std::string>> bus_alarms_;
};

/// What this filter stands for (MQTT 5 §4.7).
[[nodiscard]] bool matches(std::string_view filter, std::string_view topic);

/// `<base>/<gateway>/status`, the topic of the will.
[[nodiscard]] std::string status_topic(std::string_view base, std::string_view gateway);

}  // namespace mqtt
