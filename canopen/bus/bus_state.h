#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace canopen {

/// The CAN controller's fault confinement state (ISO 11898-1), plus an interface that is down or gone.
/// The numbers are those of Modbus register 100 + 20·k of the gateway unit.
enum class BusCondition : std::uint8_t { error_active = 0, warning = 1, passive = 2, bus_off = 3, down = 4 };

/// For people: the state's name, and what it means where that is bad.
[[nodiscard]] std::string_view describe(BusCondition condition) noexcept;

struct BusState {
  BusCondition condition = BusCondition::down;
  std::uint16_t transmit_errors = 0;  ///< Controller's transmit error counter, where the driver tells it.
  std::uint16_t receive_errors = 0;   ///< Controller's receive error counter, likewise.

  /// Frames can be exchanged.
  [[nodiscard]] bool up() const noexcept {
    return condition != BusCondition::bus_off && condition != BusCondition::down;
  }
  friend bool operator==(const BusState&, const BusState&) = default;
};

/// What is wrong on a bus beside the state of its controller.
struct BusTroubles {
  bool own_node_id = false;   ///< Another node sends heartbeats with the gateway's node id.
  bool overload = false;      ///< The load was above 90 % for a second, and not below 80 % since.
  std::string second_master;  ///< What another master does (what it sends); empty: there is none.
  friend bool operator==(const BusTroubles&, const BusTroubles&) = default;
};

/// What one bus counted since the start.
struct BusStatistics {
  std::uint64_t frames_received = 0;
  std::uint64_t frames_sent = 0;  ///< Departed (echo seen).
  std::uint32_t frames_lost = 0;
  std::uint32_t bus_offs = 0;
  std::uint32_t bitrate = 0;                 ///< bit/s; 0: not known.
  std::uint16_t load_per_mille = 0;          ///< Of the last second; 0 without a bit rate.
  std::uint16_t highest_load_per_mille = 0;  ///< Of any second since the start.
  std::uint16_t error_frames = 0;            ///< Of the last ErrorShare::kWindow frames, errors among them.
};

}  // namespace canopen
