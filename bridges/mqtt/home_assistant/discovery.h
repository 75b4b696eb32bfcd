#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/home_assistant/device.h"
#include "bridges/mqtt/home_assistant/prefixes.h"
#include "bridges/mqtt/leftovers.h"
#include "bridges/mqtt/message.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/plant_change.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt::home_assistant {

/// Tells Home Assistant of the drives, a message each on `PREFIX/device/NODE/<drive>/config`: at every connection, when
/// it says that it was started, and where somebody else wrote there. Has what the broker keeps of before removed:
/// drives that are gone, also below a prefix that was in use before, and entities that are gone. NODE is
/// `<base>_<gateway>`, with '_' for what Home Assistant takes in no topic. While another gateway of our name lives
/// nothing is told and nothing removed.
class Discovery {
 public:
  /// What the broker keeps has come by then.
  static constexpr canopen::Duration kPause = std::chrono::seconds(1);
  /// A drive is not told of again sooner, however often Home Assistant starts or somebody writes there.
  static constexpr canopen::Duration kLeast = std::chrono::seconds(10);
  /// Of one drive, of before.
  static constexpr std::size_t kMostEntities = 2000;

  /// All outlive it.
  Discovery(const config::Model& model, const config::Mqtt& settings, const Topics& topics, Leftovers& leftovers,
            std::string version);

  /// The plant and the topics changed: drives that are new or others are told of, and those that are gone removed.
  /// `model` outlives it, or the next change.
  void change(const config::Model& model, const process::PlantChange& change, canopen::TimePoint now);
  /// A new connection, to this broker.
  void connected(const std::string& broker);
  /// What is to be watched on this connection; more after prefixes_kept().
  [[nodiscard]] std::vector<Subscription> subscriptions() const;
  /// Topics::home_assistant() as the broker keeps it of before.
  void prefixes_kept(std::string_view payload) { prefixes_.read(payload); }
  /// The broker grants one of them.
  void granted(std::string_view filter);
  /// All else was published on this connection.
  void announced(canopen::TimePoint now);
  /// A message that is none of the gateway's tree. False: nor is it one of subscriptions().
  [[nodiscard]] bool heard(const Incoming& message, canopen::TimePoint now);
  /// When to come to collect().
  [[nodiscard]] canopen::TimePoint next() const;
  /// Appends the message of one drive where it is time; others of the loop get in between. Also to be called when
  /// `another_lives` changes: a gateway of our name.
  void collect(bool another_lives, canopen::TimePoint now, std::vector<Message>& out);

 private:
  /// What is told of a drive.
  struct Told {
    Entities before{};                                   ///< What the broker keeps of it, or kept, or was told.
    canopen::TimePoint due = canopen::kNever;            ///< When it is to be told of.
    std::optional<canopen::TimePoint> last{};            ///< When it was.
    std::array<std::optional<std::size_t>, 2> hashes{};  ///< Of the newest two messages.
    bool puts_right = false;                             ///< Somebody else wrote there.
    /// Where it was told of and waits for nothing.
    void tell_again_at(canopen::TimePoint at);
  };

  void name_topics();
  [[nodiscard]] std::string topic_of(std::string_view prefix, std::string_view drive) const;
  [[nodiscard]] std::string birth_topic() const;
  void kept(const std::string& prefix, const Incoming& message, canopen::TimePoint now);
  void written(Told& drive, canopen::TimePoint now);
  void tell_all_at(canopen::TimePoint at);
  [[nodiscard]] Told* find(std::string_view topic);
  void tell(std::size_t index, canopen::TimePoint now, std::vector<Message>& out);

  const config::Model* model_;
  const config::Mqtt& settings_;
  const Topics& topics_;
  Leftovers& leftovers_;
  std::string version_;
  std::string node_;
  Prefixes prefixes_;
  std::map<std::string, std::size_t, std::less<>> topics_of_drives_;  ///< Positions by topic; empty: switched off.
  std::vector<Told> drives_;                                          ///< By position.
  std::string broker_;
  std::set<std::string> told_at_;   ///< Brokers at which drives were told of.
  canopen::TimePoint tell_from_{};  ///< On this connection; a gateway of our name that lives would have been heard.
  bool another_lives_ = false;
};

}  // namespace mqtt::home_assistant
