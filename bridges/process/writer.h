#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace process {

/// Who gives a command: a Modbus client by its address, MQTT as a whole, the local command line, or the gateway
/// itself (what a time-out writes).
struct Writer {
  enum class Way : std::uint8_t { modbus, mqtt, local, gateway };
  Way way = Way::local;
  std::string address;  ///< Of the Modbus client, without its port; empty otherwise.
  std::string user{};   ///< Of the local command, by the kernel's word; empty otherwise.

  /// Whoever comes by the local way is one writer.
  friend bool operator==(const Writer& a, const Writer& b) noexcept { return a.way == b.way && a.address == b.address; }
};

/// `modbus`, `mqtt`, `local`, `gateway`
[[nodiscard]] std::string_view name_of(Writer::Way way) noexcept;
/// `modbus 192.0.2.7`, `mqtt`, `local root`, `gateway`
[[nodiscard]] std::string to_string(const Writer& writer);

}  // namespace process
