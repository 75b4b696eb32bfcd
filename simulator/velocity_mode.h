#pragma once

#include <cstdint>

#include "simulator/cia402.h"
#include "simulator/motor.h"
#include "simulator/record.h"

namespace simulator {

/// How the drive leaves operation enabled (0x605A..0x605C).
struct VelocityOptions {
  bool quick_stop_coasts = false;
  bool shutdown_ramps = false;
  bool disable_ramps = true;
  double quick_stop_hz_s = 20.0;
};

/// CiA 402 velocity mode (vl): the state machine moves the motor.
class VelocityMode {
 public:
  VelocityMode(Motor& motor, Record& record) : motor_(motor), record_(record) {}

  /// True when it has reset a fault.
  bool control(std::uint16_t word);
  void set_target_rpm(double rpm);
  void set_amounts(double minimum_rpm, double maximum_rpm);
  void trip();
  void reset_fault();
  void disable_voltage();
  void quick_stop();
  void step();

  [[nodiscard]] VelocityOptions& options() noexcept { return options_; }
  [[nodiscard]] std::uint16_t controlword() const noexcept { return machine_.controlword(); }
  [[nodiscard]] std::uint16_t statusword(bool warning, bool local) const;
  [[nodiscard]] double actual_rpm() const noexcept { return motor_.shaft_rpm(); }
  [[nodiscard]] double demand_rpm() const noexcept;
  /// What the motor reaches at its greatest frequency.
  [[nodiscard]] double highest_rpm() const noexcept;

 private:
  void apply(Cia402State before, bool moved_before);
  void leave_operation(Cia402State now);

  Motor& motor_;
  Record& record_;
  Cia402 machine_;
  VelocityOptions options_;
  double target_rpm_ = 0.0;
  double minimum_rpm_ = 0.0;
  double maximum_rpm_ = 1e9;
  bool limited_ = false;
};

}  // namespace simulator
