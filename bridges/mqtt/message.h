#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "canopen/clock.h"

namespace mqtt {

enum class MessageKind : std::uint8_t {
  value,  ///< The newest one is all that counts.
  alarm,  ///< Likewise, but it never gives way to values.
  answer  ///< Each counts by itself.
};

/// Something to publish.
struct Message {
  std::string topic{};
  std::string payload{};
  MessageKind kind = MessageKind::value;
  bool retained = true;
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
