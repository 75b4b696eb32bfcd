#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/put_right.h"
#include "canopen/clock.h"
#include "config/model.h"

namespace mqtt {

/// `online` or `offline` on one retained topic: a change is told at once, `online` is told again before it expires, and
/// what somebody else wrote there is put right. The others return when to come to collect(); kNever: not because of
/// that.
class StatusTopic {
 public:
  /// `topic` and `settings` outlive it. `after_all`: the first `online` of a connection says that
  /// everything else is there, and the last `offline` that nothing else comes.
  StatusTopic(const std::string& topic, const config::Mqtt& settings, bool after_all = false)
      : topic_(&topic), settings_(&settings), after_all_(after_all) {}

  /// A new connection: it is due whatever it says.
  void forget();
  /// Somebody published there, perhaps we ourselves.
  canopen::TimePoint received(std::string_view payload, canopen::TimePoint now);
  /// When it is due as long as it does not change.
  [[nodiscard]] canopen::TimePoint next() const;
  /// Appends it where it is due or changed.
  void collect(bool online, canopen::TimePoint now, std::vector<Message>& out);
  /// What an orderly end says.
  [[nodiscard]] Message offline() const;

 private:
  const std::string* topic_;
  const config::Mqtt* settings_;
  bool after_all_;
  std::optional<bool> online_;       ///< As published on this connection.
  canopen::TimePoint published_{};   ///< When.
  canopen::TimePoint echo_until_{};  ///< What was said before the last change may come back so long.
  PutRight put_right_;
};

}  // namespace mqtt
