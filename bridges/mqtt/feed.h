#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/pace.h"
#include "bridges/mqtt/status_topic.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/drive.h"
#include "config/model.h"

namespace mqtt {

/// What one drive has to tell but its alarms: marks what changed as it happens, and writes it out once per turn of the
/// loop, and where something must not wait. The marks return when something is due; TimePoint::max() where nothing is,
/// kAtOnce where it waits for nothing.
class Feed {
 public:
  /// All outlive the feed.
  Feed(const process::Drive& drive, const DriveTopics& topics, const config::Mqtt& settings);

  [[nodiscard]] const std::string& drive_name() const noexcept { return drive_.model().name; }

  canopen::TimePoint mark_values(std::span<const process::SignalId> signals, canopen::TimePoint now);
  canopen::TimePoint mark_status(canopen::TimePoint now);
  canopen::TimePoint mark_control(canopen::TimePoint now);
  /// Somebody published on the topic of the status, perhaps we ourselves.
  canopen::TimePoint status_received(std::string_view payload, canopen::TimePoint now) {
    return status_.received(payload, now);
  }
  /// The status is due whatever it says.
  void forget_status() { status_.forget(); }
  /// Everything is due: a new connection.
  void mark_all();

  /// A boolean or a name changed: collected now it is told even where it changes back in the same turn.
  [[nodiscard]] bool must_not_wait() const noexcept { return pace_.has_switched(); }
  /// Appends what is due; returns when something is due next.
  canopen::TimePoint collect(canopen::TimePoint now, std::vector<Message>& out);

  /// Appends what an orderly end says of the drive: nothing of it is live any more.
  void collect_last(std::vector<Message>& out) const;

 private:
  void collect_signals(canopen::TimePoint now, std::vector<Message>& out);
  void collect_state(canopen::TimePoint now, std::vector<Message>& out);

  const process::Drive& drive_;
  const DriveTopics& topics_;
  const config::Mqtt& settings_;
  Pace pace_;
  StatusTopic status_;
  std::optional<bool> online_;  ///< As published.
  std::optional<canopen::NmtState> nmt_;
  bool fresh_ = false;
  bool control_due_ = true;
};

}  // namespace mqtt
