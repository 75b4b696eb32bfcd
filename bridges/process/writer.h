#pragma once

#include <cstdint>
#include <string>

namespace process {

/// Who gives a command: a Modbus client by its address, MQTT as a whole, or the local command line.
struct Writer {
  enum class Way : std::uint8_t { modbus, mqtt, local };
  Way way = Way::local;
  std::string address;  ///< Of the Modbus client, without its port; empty otherwise.
  std::string user{};   ///< Of the local command, by the kernel's word; empty otherwise.

  /// Whoever comes by the local way is one writer.
  friend bool operator==(const Writer& a, const Writer& b) noexcept { return a.way == b.way && a.address == b.address; }
};

/// `modbus 192.0.2.7`, `mqtt`, `local`
[[nodiscard]] std::string to_string(const Writer& writer);

}  // namespace process
