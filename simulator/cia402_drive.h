#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "simulator/model.h"
#include "simulator/velocity_mode.h"

namespace simulator {

/// A frequency converter by the book: CiA 402 velocity mode and CiA 301 without quirks.
class Cia402Drive final : public Model {
 public:
  Cia402Drive();

  [[nodiscard]] std::string_view kind() const override { return "cia402-velocity"; }
  [[nodiscard]] const Traits& traits() const override { return traits_; }
  void start(Drive& drive) override;
  void step(canopen::Duration passed) override;
  void raise_fault(std::uint16_t code) override;
  void raise_warning(std::uint16_t code) override { warning_ = code; }
  void clear_faults() override;
  [[nodiscard]] std::uint16_t fault() const override { return fault_; }
  [[nodiscard]] std::uint16_t warning() const override { return warning_; }
  void on_connection_lost(ConnectionLoss loss) override;

 private:
  struct Ramp {
    std::uint32_t delta_speed = 300;  ///< rpm
    std::uint16_t delta_time = 1;     ///< s
    [[nodiscard]] double rpm_s() const noexcept { return static_cast<double>(delta_speed) / delta_time; }
  };
  struct Fraction {
    std::int32_t numerator = 1;
    std::int32_t denominator = 1;
    [[nodiscard]] double value() const noexcept { return static_cast<double>(numerator) / denominator; }
  };

  void define_control();
  void define_velocity();
  void define_options();
  void define_ramp(std::uint16_t index, Ramp& ramp);
  void define_fraction(std::uint16_t index, std::uint8_t size, Fraction& fraction);
  void apply();
  /// Units of 6042 and 6044 per rpm.
  [[nodiscard]] double units_per_rpm() const noexcept;

  Traits traits_;
  Drive* drive_ = nullptr;
  std::optional<VelocityMode> velocity_;
  std::uint16_t target_ = 0;  ///< 6042 as written
  std::array<std::uint32_t, 2> amounts_{};
  Ramp acceleration_;
  Ramp deceleration_;
  Ramp quick_stop_;
  Fraction set_point_factor_;
  Fraction dimension_factor_;
  std::int16_t abort_connection_ = 1;  ///< 6007
  std::uint16_t fault_ = 0;
  std::uint16_t warning_ = 0;
};

}  // namespace simulator
