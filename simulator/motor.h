#pragma once

#include <cstdint>

#include "canopen/clock.h"

namespace simulator {

/// The motor and the power part: ratings and ramps.
struct MotorRating {
  double base_hz = 50.0;
  double max_hz = 50.0;
  double acceleration_hz_s = 10.0;
  double deceleration_hz_s = 10.0;
  double coast_hz_s = 5.0;  ///< How fast the free shaft slows down.
  double rated_a = 10.0;
  double rated_v = 220.0;
  double mains_v = 220.0;
  unsigned pole_pairs = 2;
};

enum class MotorState : std::uint8_t { stopped, running, stopping, coasting };

/// A plausible motor on ramps: enough physics to make every reading move the way a fitter expects, and no more.
class Motor {
 public:
  explicit Motor(const MotorRating& rating = {}) : rating_(rating) {}

  /// Ramps to the target and holds it. Turns round through zero when the direction changes.
  void run(bool reverse);
  void stop();                     ///< Ramps down to standstill.
  void stop_quickly(double hz_s);  ///< The same on another ramp.
  void coast();                    ///< Output off; the shaft runs out.
  void switch_off();               ///< Standstill at once, as after a power cycle.
  /// Set-point in Hz, held within 0..max_hz. Moves nothing by itself.
  void set_target(double hz);
  void set_ramps(double acceleration_hz_s, double deceleration_hz_s);
  void step(canopen::Duration passed);

  [[nodiscard]] const MotorRating& rating() const noexcept { return rating_; }
  [[nodiscard]] MotorState state() const noexcept { return state_; }
  /// The output is on: running, or ramping down.
  [[nodiscard]] bool output_on() const noexcept {
    return state_ == MotorState::running || state_ == MotorState::stopping;
  }
  [[nodiscard]] bool accelerating() const noexcept { return change_ > 0; }
  [[nodiscard]] bool decelerating() const noexcept { return change_ < 0; }
  [[nodiscard]] bool reverse() const noexcept;

  [[nodiscard]] double target_hz() const noexcept { return target_hz_; }  ///< >= 0
  [[nodiscard]] double output_hz() const noexcept;                        ///< signed; 0 with the output off
  [[nodiscard]] double ramp_hz() const noexcept { return output_hz(); }   ///< the set-point behind the ramp
  [[nodiscard]] double shaft_rpm() const noexcept;                        ///< signed, 60 f / pole pairs
  [[nodiscard]] double torque_percent() const noexcept;                   ///< signed, of rated torque
  [[nodiscard]] double current_a() const noexcept;
  [[nodiscard]] double power_percent() const noexcept;
  [[nodiscard]] double output_v() const noexcept;
  [[nodiscard]] double input_v() const noexcept { return rating_.mains_v; }
  [[nodiscard]] double dc_bus_v() const noexcept;
  [[nodiscard]] double temperature_c() const noexcept { return temperature_c_; }  ///< of the power module

 private:
  MotorRating rating_;
  MotorState state_ = MotorState::stopped;
  bool reverse_wanted_ = false;
  double stop_hz_s_ = 0.0;  ///< ramp of the stop under way
  double target_hz_ = 0.0;
  double shaft_hz_ = 0.0;  ///< signed
  int change_ = 0;         ///< of the amount of speed: +1 growing, -1 shrinking
  double temperature_c_ = 30.0;
};

}  // namespace simulator
