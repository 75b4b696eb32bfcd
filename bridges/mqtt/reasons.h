#pragma once

#include <string>
#include <vector>

namespace mqtt {

/// What a broker says with a code, by name: `Session taken over (0x8E)`. MQTT 5 §2.4; of CONNACK also the codes of
/// 3.1.1 (§3.2.2.3), all of which are below 0x80.
[[nodiscard]] std::string reason_text(int code);

/// It is a failure (MQTT 5 §2.4; in a SUBACK of 3.1.1 it is 0x80, §3.9.3).
[[nodiscard]] constexpr bool is_failure(int code) {
  return code >= 0x80;
}
/// CONNACK of a broker that does not speak MQTT 5.
[[nodiscard]] constexpr bool refuses_version(int code) {
  return code == 1 || code == 0x84;
}
/// CONNACK that does not change by itself: user name, password, rights, banned.
[[nodiscard]] constexpr bool refuses_credentials(int code) {
  return code == 4 || code == 5 || code == 0x86 || code == 0x87 || code == 0x8A;
}
/// DISCONNECT for a reason that is not about a message: busy, shutting down, timeouts, take-over, an administrator, use
/// of another server, too many connections.
[[nodiscard]] constexpr bool spares_messages(int code) {
  return code == 0x89 || code == 0x8B || code == 0x8D || code == 0x8E || code == 0x98 || code == 0x9C || code == 0x9D ||
         code == 0x9F || code == 0xA0;
}
/// DISCONNECT because another client connected with our client id.
[[nodiscard]] constexpr bool is_takeover(int code) {
  return code == 0x8E;
}

/// The text without the paths in it, the empty ones of which are none: readers of the broker are not told where files
/// of this machine lie.
[[nodiscard]] std::string without_paths(std::string text, const std::vector<std::string>& paths);

}  // namespace mqtt
