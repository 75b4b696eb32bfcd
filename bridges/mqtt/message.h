#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "canopen/clock.h"

namespace mqtt {

/// In the order in which they leave.
enum class MessageKind : std::uint8_t {
  status,  ///< Whether the gateway and its drives are there. The newest one is all that counts.
  alarm,   ///< Likewise.
  answer,  ///< Each counts by itself, for a short time.
  value    ///< The newest one is all that counts.
};

/// Something to publish.
struct Message {
  std::string topic{};
  std::string payload{};
  MessageKind kind = MessageKind::value;
  bool retained = true;
  /// MQTT 5 only: how long it stands at a broker without being published again, in seconds; 0: for ever.
  std::uint32_t expiry = 0;
  /// It leaves when all that waits with it has left: `online` says that everything is there.
  bool after_all = false;
  /// It says again what somebody else had overwritten.
  bool puts_right = false;
  std::optional<std::string> correlation{};  ///< MQTT 5 only: correlation data of the request it answers.
  friend bool operator==(const Message&, const Message&) = default;
};

/// Something that came from the broker.
struct Incoming {
  std::string topic{};
  std::string payload{};
  bool retained = false;
  bool redelivered = false;      ///< The broker says that it may have come before (DUP).
  std::string response_topic{};  ///< Empty: none named.
  std::optional<std::string> correlation{};
  std::optional<std::uint32_t> expiry{};  ///< What is left of the message expiry interval, in seconds.
  canopen::TimePoint received{};
};

}  // namespace mqtt
