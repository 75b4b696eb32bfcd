#pragma once

#include <cstdint>
#include <optional>

#include "simulator/model.h"
#include "simulator/velocity_mode.h"

namespace simulator {

/// A Danfoss Vacon drive with the OPTE6 board.
class Opte6 final : public Model {
 public:
  Opte6();

  [[nodiscard]] std::string_view kind() const override { return "vacon-opte6"; }
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
  void define_velocity_mode();
  void define_monitoring();
  void define_readings();

  Traits traits_;
  Drive* drive_ = nullptr;
  std::optional<VelocityMode> velocity_;
  std::uint16_t target_ = 0;  ///< 6042 as written
  std::uint8_t mode_ = 0;     ///< 2005
  std::uint16_t fault_ = 0;
  std::uint16_t warning_ = 0;
};

}  // namespace simulator
