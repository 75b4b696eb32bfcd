#pragma once

#include <cstdint>

namespace simulator {

enum class Cia402State : std::uint8_t {
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault
};

/// The CiA 402 power drive state machine. One controlword makes at most one transition, as the standard draws it.
class Cia402 {
 public:
  void reset() noexcept;
  /// Takes a controlword. True when it has reset a fault.
  bool control(std::uint16_t word) noexcept;
  /// Transitions 13 and 14.
  void trip() noexcept { state_ = Cia402State::fault; }
  /// Transition 15 without a controlword: reset at the drive.
  void reset_fault() noexcept;
  /// Transition 12: after a quick stop the drive is at rest.
  void end_quick_stop() noexcept;
  /// Transition 9: "disable voltage", whatever the state.
  void disable_voltage() noexcept;
  /// Transition 11.
  void quick_stop() noexcept;

  [[nodiscard]] Cia402State state() const noexcept { return state_; }
  [[nodiscard]] std::uint16_t controlword() const noexcept { return controlword_; }
  /// Operation enabled and not halted by bit 8.
  [[nodiscard]] bool wants_motion() const noexcept;
  /// Bits 0..6 of the statusword, with bit 4 (voltage enabled) set.
  [[nodiscard]] std::uint16_t status_bits() const noexcept;

 private:
  Cia402State state_ = Cia402State::switch_on_disabled;
  std::uint16_t controlword_ = 0;
};

}  // namespace simulator
