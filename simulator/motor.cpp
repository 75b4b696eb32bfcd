#include "simulator/motor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace simulator {

void Motor::run(bool reverse) {
  state_ = MotorState::running;
  reverse_wanted_ = reverse;
}

void Motor::stop() {
  stop_quickly(rating_.deceleration_hz_s);
}

void Motor::stop_quickly(double hz_s) {
  if (state_ == MotorState::running) {
    state_ = MotorState::stopping;
    stop_hz_s_ = hz_s;
  }
}

void Motor::coast() {
  if (output_on()) {
    state_ = MotorState::coasting;
  }
}

void Motor::switch_off() {
  state_ = MotorState::stopped;
  shaft_hz_ = 0.0;
  target_hz_ = 0.0;
  change_ = 0;
}

void Motor::set_target(double hz) {
  target_hz_ = std::clamp(hz, 0.0, rating_.max_hz);
}

void Motor::set_ramps(double acceleration_hz_s, double deceleration_hz_s) {
  rating_.acceleration_hz_s = acceleration_hz_s;
  rating_.deceleration_hz_s = deceleration_hz_s;
}

void Motor::step(canopen::Duration passed) {
  const double seconds = std::chrono::duration<double>(passed).count();
  double wanted = 0.0;
  if (state_ == MotorState::running) {
    wanted = reverse_wanted_ ? -target_hz_ : target_hz_;
  }
  // Through zero first when the sign changes: braking and accelerating have their own ramps.
  const bool turning_round = wanted * shaft_hz_ < 0.0;
  const double aim = turning_round ? 0.0 : wanted;
  const bool growing = std::abs(aim) > std::abs(shaft_hz_);
  double slope = growing ? rating_.acceleration_hz_s : rating_.deceleration_hz_s;
  if (state_ == MotorState::coasting) {
    slope = rating_.coast_hz_s;
  } else if (state_ == MotorState::stopping) {
    slope = stop_hz_s_;
  }
  const double reach = slope * seconds;
  const double gap = aim - shaft_hz_;
  change_ = 0;
  if (gap != 0.0) {
    change_ = growing ? 1 : -1;
  }
  shaft_hz_ = std::abs(gap) <= reach ? aim : shaft_hz_ + std::copysign(reach, gap);
  if (shaft_hz_ == 0.0 && (state_ == MotorState::stopping || state_ == MotorState::coasting)) {
    state_ = MotorState::stopped;
    change_ = 0;
  }
  const double settled = output_on() ? 35.0 + current_a() / rating_.rated_a * 20.0 : 30.0;
  temperature_c_ += (settled - temperature_c_) * std::min(1.0, seconds / 60.0);
}

bool Motor::reverse() const noexcept {
  return shaft_hz_ != 0.0 ? shaft_hz_ < 0.0 : reverse_wanted_;
}

double Motor::output_hz() const noexcept {
  return output_on() ? shaft_hz_ : 0.0;
}

double Motor::shaft_rpm() const noexcept {
  return shaft_hz_ * 60.0 / rating_.pole_pairs;
}

double Motor::torque_percent() const noexcept {
  if (!output_on() || (shaft_hz_ == 0.0 && change_ == 0)) {
    return 0.0;
  }
  // A fan: friction, the square of the speed, and what the ramp asks for.
  const double share = std::abs(shaft_hz_) / rating_.base_hz;
  const double torque = 5.0 + 60.0 * share * share + 30.0 * change_;
  return shaft_hz_ < 0.0 ? -torque : torque;
}

double Motor::current_a() const noexcept {
  if (!output_on()) {
    return 0.0;
  }
  return rating_.rated_a * std::hypot(0.3, 0.95 * torque_percent() / 100.0);
}

double Motor::power_percent() const noexcept {
  return std::abs(torque_percent() * output_hz() / rating_.base_hz);
}

double Motor::output_v() const noexcept {
  return rating_.rated_v * std::min(1.0, std::abs(output_hz()) / rating_.base_hz);
}

double Motor::dc_bus_v() const noexcept {
  const double idle = rating_.mains_v * std::numbers::sqrt2;
  const double sag = 10.0 * current_a() / rating_.rated_a;
  return idle - sag + (output_on() && change_ < 0 ? 40.0 : 0.0);  // Braking pumps the bus up.
}

}  // namespace simulator
