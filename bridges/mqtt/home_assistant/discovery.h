#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/broker.h"
#include "bridges/mqtt/home_assistant/device.h"
#include "bridges/mqtt/leftovers.h"
#include "bridges/mqtt/message.h"
#include "bridges/mqtt/topics.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt::home_assistant {

/// Tells Home Assistant of the drives, a message each on `PREFIX/device/NODE/<drive>/config`: at every connection, and
/// when it says that it was started. Has what the broker keeps of before removed: drives that are gone, also below a
/// prefix that was in use before, and entities that are gone. NODE is `<base>_<gateway>`, with '_' for what Home
/// Assistant takes in no topic.
class Discovery {
 public:
  /// What the broker keeps has come by then.
  static constexpr canopen::Duration kPause = std::chrono::seconds(1);
  /// It is not told again sooner, however often it starts.
  static constexpr canopen::Duration kLeast = std::chrono::seconds(10);
  /// Of one drive, of before; and prefixes of before.
  static constexpr std::size_t kMostEntities = 2000;
  static constexpr std::size_t kMostPrefixes = 16;

  /// All outlive it.
  Discovery(const config::Model& model, const config::Mqtt& settings, const Topics& topics, Leftovers& leftovers,
            std::string version);

  /// What is to be watched; more after info_kept().
  [[nodiscard]] std::vector<Subscription> subscriptions() const;
  /// `B/info` as the broker keeps it of before: it names the prefix of then.
  void info_kept(std::string_view info);
  /// A new connection.
  void announced(canopen::TimePoint now);
  /// A message that is none of the gateway's tree. False: nor is it one of subscriptions().
  [[nodiscard]] bool heard(const Incoming& message, canopen::TimePoint now);
  /// When to come to collect().
  [[nodiscard]] canopen::TimePoint next() const noexcept { return due_; }
  /// Appends the message of one drive where it is time; others of the loop get in between.
  void collect(canopen::TimePoint now, std::vector<Message>& out);

 private:
  [[nodiscard]] std::string topic_of(std::string_view prefix, std::string_view drive) const;
  [[nodiscard]] std::string birth_topic() const;
  void kept(const Incoming& message, canopen::TimePoint now);
  void tell_all_at(canopen::TimePoint at);

  const config::Model& model_;
  const config::Mqtt& settings_;
  const Topics& topics_;
  Leftovers& leftovers_;
  std::string version_;
  std::string node_;
  std::set<std::string> prefixes_;  ///< In use now, and of before.
  std::vector<Entities> before_;    ///< By drive: what the broker keeps of it, or kept.
  std::size_t drive_ = 0;           ///< The next one to be told of.
  canopen::TimePoint told_ = canopen::TimePoint::min();
  canopen::TimePoint due_ = canopen::kNever;
};

}  // namespace mqtt::home_assistant
