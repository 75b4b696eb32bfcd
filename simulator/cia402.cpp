#include "simulator/cia402.h"

#include <utility>

namespace simulator {
namespace {

enum class Order : std::uint8_t { shutdown, switch_on, enable_operation, disable_voltage, quick_stop };

/// CiA 402-2 table "command coding".
Order order_of(std::uint16_t word) {
  if ((word & 0x02U) == 0) {
    return Order::disable_voltage;
  }
  if ((word & 0x04U) == 0) {
    return Order::quick_stop;
  }
  if ((word & 0x01U) == 0) {
    return Order::shutdown;
  }
  return (word & 0x08U) != 0 ? Order::enable_operation : Order::switch_on;
}

Cia402State next(Cia402State state, Order order) {
  using enum Cia402State;
  switch (state) {
    case switch_on_disabled:
      return order == Order::shutdown ? ready_to_switch_on : state;
    case ready_to_switch_on:
      if (order == Order::disable_voltage || order == Order::quick_stop) {
        return switch_on_disabled;
      }
      return order == Order::switch_on || order == Order::enable_operation ? switched_on : state;
    case switched_on:
    case operation_enabled:
      switch (order) {
        case Order::shutdown:
          return ready_to_switch_on;
        case Order::disable_voltage:
          return switch_on_disabled;
        case Order::switch_on:
          return switched_on;
        case Order::enable_operation:
          return operation_enabled;
        case Order::quick_stop:
          return state == operation_enabled ? quick_stop_active : switch_on_disabled;
      }
      return state;
    case quick_stop_active:
      if (order == Order::disable_voltage) {
        return switch_on_disabled;
      }
      return order == Order::enable_operation ? operation_enabled : state;
    case fault:
      break;
  }
  return state;
}

}  // namespace

void Cia402::reset() noexcept {
  state_ = Cia402State::switch_on_disabled;
  controlword_ = 0;
}

bool Cia402::control(std::uint16_t word) noexcept {
  const std::uint16_t before = std::exchange(controlword_, word);
  const bool rising_reset = (word & 0x80U) != 0 && (before & 0x80U) == 0;
  if (state_ == Cia402State::fault) {
    if (rising_reset) {
      reset_fault();
    }
    return rising_reset;
  }
  state_ = next(state_, order_of(word));
  return false;
}

void Cia402::reset_fault() noexcept {
  if (state_ == Cia402State::fault) {
    state_ = Cia402State::switch_on_disabled;
  }
}

void Cia402::end_quick_stop() noexcept {
  if (state_ == Cia402State::quick_stop_active) {
    state_ = Cia402State::switch_on_disabled;
  }
}

void Cia402::disable_voltage() noexcept {
  if (state_ != Cia402State::fault) {
    state_ = Cia402State::switch_on_disabled;
  }
}

void Cia402::quick_stop() noexcept {
  if (state_ == Cia402State::operation_enabled) {
    state_ = Cia402State::quick_stop_active;
  }
}

bool Cia402::wants_motion() const noexcept {
  return state_ == Cia402State::operation_enabled && (controlword_ & 0x100U) == 0;
}

std::uint16_t Cia402::status_bits() const noexcept {
  constexpr std::uint16_t kVoltage = 0x10;
  switch (state_) {
    case Cia402State::ready_to_switch_on:
      return 0x21 | kVoltage;
    case Cia402State::switched_on:
      return 0x23 | kVoltage;
    case Cia402State::operation_enabled:
      return 0x27 | kVoltage;
    case Cia402State::quick_stop_active:
      return 0x07 | kVoltage;
    case Cia402State::fault:
      return 0x08 | kVoltage;
    case Cia402State::switch_on_disabled:
      break;
  }
  return 0x40 | kVoltage;
}

}  // namespace simulator
