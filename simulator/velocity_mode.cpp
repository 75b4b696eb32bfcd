#include "simulator/velocity_mode.h"

#include <algorithm>
#include <cmath>

namespace simulator {

bool VelocityMode::control(std::uint16_t word) {
  const Cia402State before = machine_.state();
  const bool moved_before = machine_.wants_motion();
  const bool fault_reset = machine_.control(word);
  apply(before, moved_before);
  return fault_reset;
}

void VelocityMode::apply(Cia402State before, bool moved_before) {
  if (machine_.wants_motion()) {
    if (!moved_before) {
      ++record_.run_commands;
      motor_.run(target_rpm_ < 0.0);
    }
    return;
  }
  if (machine_.state() == Cia402State::operation_enabled) {
    motor_.stop();  // Halt; the drive stays enabled.
  } else if (before != machine_.state()) {
    leave_operation(machine_.state());
  }
}

void VelocityMode::leave_operation(Cia402State now) {
  if (now == Cia402State::quick_stop_active && !options_.quick_stop_coasts) {
    motor_.stop_quickly(options_.quick_stop_hz_s);
  } else if ((now == Cia402State::switched_on && options_.disable_ramps) ||
             (now == Cia402State::ready_to_switch_on && options_.shutdown_ramps)) {
    motor_.stop();
  } else {
    motor_.coast();
  }
}

void VelocityMode::set_target_rpm(double rpm) {
  target_rpm_ = rpm;
  const double highest = std::min(maximum_rpm_, highest_rpm());
  const double amount = std::clamp(std::abs(rpm), std::min(minimum_rpm_, highest), highest);
  limited_ = amount != std::abs(rpm);
  motor_.set_target(amount * motor_.rating().pole_pairs / 60.0);
  if (machine_.wants_motion()) {
    motor_.run(rpm < 0.0);
  }
}

void VelocityMode::set_amounts(double minimum_rpm, double maximum_rpm) {
  minimum_rpm_ = minimum_rpm;
  maximum_rpm_ = maximum_rpm;
  set_target_rpm(target_rpm_);
}

void VelocityMode::trip() {
  machine_.trip();
  motor_.coast();
}

void VelocityMode::reset_fault() {
  machine_.reset_fault();
}

void VelocityMode::disable_voltage() {
  machine_.disable_voltage();
  motor_.coast();
}

void VelocityMode::quick_stop() {
  const Cia402State before = machine_.state();
  const bool moved_before = machine_.wants_motion();
  machine_.quick_stop();
  apply(before, moved_before);
}

void VelocityMode::step() {
  if (machine_.state() == Cia402State::quick_stop_active && motor_.state() == MotorState::stopped) {
    machine_.end_quick_stop();
  }
}

double VelocityMode::highest_rpm() const noexcept {
  return motor_.rating().max_hz * 60.0 / motor_.rating().pole_pairs;
}

double VelocityMode::demand_rpm() const noexcept {
  return motor_.ramp_hz() * 60.0 / motor_.rating().pole_pairs;
}

std::uint16_t VelocityMode::statusword(bool warning, bool local) const {
  constexpr unsigned kWarning = 1U << 7U;
  constexpr unsigned kRemote = 1U << 9U;
  constexpr unsigned kTargetReached = 1U << 10U;
  constexpr unsigned kInternalLimit = 1U << 11U;
  const bool reached = machine_.wants_motion() && !motor_.accelerating() && !motor_.decelerating();
  const unsigned word = machine_.status_bits() | (local ? 0U : kRemote) | (warning ? kWarning : 0U) |
                        (reached ? kTargetReached : 0U) | (limited_ ? kInternalLimit : 0U);
  return static_cast<std::uint16_t>(word);
}

}  // namespace simulator
