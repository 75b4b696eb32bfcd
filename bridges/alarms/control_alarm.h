#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace alarms {

/// Why the alarm `control` is active: the closed list of its reasons.
enum class ControlReason : std::uint8_t {
  timeout,         ///< No sign of life of the writer: what `on_timeout` says was done.
  timeout_failed,  ///< The same, and its values are not confirmed.
  feedback         ///< A run command was confirmed, and the motor does not run.
};

/// `timeout`, `timeout-failed`, `feedback`
[[nodiscard]] std::string_view name_of(ControlReason reason) noexcept;

struct ControlAlarm {
  ControlReason reason = ControlReason::timeout;
  std::string text;  ///< For people.
  friend bool operator==(const ControlAlarm&, const ControlAlarm&) = default;
};

}  // namespace alarms
