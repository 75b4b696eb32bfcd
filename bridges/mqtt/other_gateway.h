#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/notice.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// Whether another gateway of our name lives: it publishes `B/health` or `B/info` with another instance than ours, or
/// its client took our client id. That lasts until nothing was heard of it for lifetime() in which we could have heard
/// it.
class OtherGateway {
 public:
  /// What is read of one that has not told its instance.
  static constexpr const char* kUnknown = "unknown";

  /// `instance` is ours. `settings` outlives it. `change` is called when the condition begins and ends.
  OtherGateway(std::string instance, const config::Mqtt& settings, Notice notice, std::function<void()> change)
      : instance_(std::move(instance)), settings_(settings), notice_(std::move(notice)), change_(std::move(change)) {}

  /// `broker`: place_of() it.
  void connected(const std::string& broker);
  /// What it publishes is heard from now on.
  void listening(canopen::TimePoint now);
  void lost();
  /// A message on `B/health` or `B/info`, of anybody. True: it was kept, and is of somebody who published while we were
  /// away and was never heard beside us, so that our connection may have ended for the sake of his.
  bool heard(const Incoming& message, canopen::TimePoint now);
  /// The broker ended our connection for the sake of another one with our client id.
  void took_over(canopen::TimePoint now);
  /// Time passed.
  void tick(canopen::TimePoint now);

  [[nodiscard]] const std::string& instance() const noexcept { return instance_; }
  /// Its instance, or kUnknown; nothing: there is no other.
  [[nodiscard]] const std::optional<std::string>& who() const noexcept { return who_; }
  [[nodiscard]] bool lives() const noexcept { return who_.has_value(); }
  /// When tick() has something to do.
  [[nodiscard]] canopen::TimePoint next() const noexcept { return listening_ && who_ ? until_ : canopen::kNever; }

 private:
  /// What a message says of its publisher.
  struct Sign {
    std::string instance;
    std::string ts;
  };
  static std::optional<Sign> sign_of(const std::string& payload);
  void note(const std::string& instance, const std::string& how, canopen::TimePoint now);

  std::string instance_;
  const config::Mqtt& settings_;
  Notice notice_;
  std::function<void()> change_;
  std::optional<std::string> who_;
  std::string beside_;  ///< Instance that was heard while we were connected: it has a client id of its own.
  canopen::TimePoint until_{};
  bool listening_ = false;
  std::string broker_;
  /// By broker: what it kept when we came there first, as a rule of our last life.
  std::map<std::string, std::optional<Sign>> before_;
  bool first_ = true;  ///< This is the first connection to the broker that got as far as listening().
};

}  // namespace mqtt
