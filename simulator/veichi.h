#pragma once

#include <cstdint>
#include <map>
#include <memory>

#include "simulator/model.h"
#include "simulator/options.h"

namespace simulator {

enum class VeichiSeries : std::uint8_t { ac300, ac310 };

/// Veichi AC300 or AC310 with the AC300CAN1 card, as the card's manual has it.
class Veichi final : public Model {
 public:
  Veichi(VeichiSeries series, const DriveOptions& options);

  [[nodiscard]] std::string_view kind() const override;
  [[nodiscard]] const Traits& traits() const override { return traits_; }
  void start(Drive& drive) override;
  void step(canopen::Duration passed) override;
  void raise_fault(std::uint16_t code) override;
  void raise_warning(std::uint16_t code) override;
  void clear_faults() override;
  [[nodiscard]] std::uint16_t fault() const override { return fault_; }
  [[nodiscard]] std::uint16_t warning() const override { return warning_; }
  [[nodiscard]] AnswerStyle answer_style(Address address, bool write) const override;

 private:
  /// Group times 256 plus number: F01.05 is 0x0105.
  using Parameter = std::uint16_t;

  void define_parameters();
  void define_control_block();
  void define_monitoring();
  [[nodiscard]] std::optional<Object> parameter_object(Address address);
  [[nodiscard]] bool obeys_bus_commands() const;
  [[nodiscard]] bool obeys_bus_frequency() const;
  Abort command(std::uint32_t code);
  Abort set_frequency(std::uint32_t hundredths);
  void apply_target();
  [[nodiscard]] std::uint16_t status() const;

  VeichiSeries series_;
  DriveOptions options_;
  Traits traits_;
  Drive* drive_ = nullptr;
  std::map<Parameter, std::uint16_t> stored_;      ///< EEPROM: survives a power cycle.
  std::map<Parameter, std::uint16_t> parameters_;  ///< What is in force.
  std::uint16_t frequency_ = 0;                    ///< 0.01 Hz, as commanded
  std::uint16_t upper_limit_ = 0;                  ///< 0.01 Hz
  bool jogging_ = false;
  std::uint16_t fault_ = 0;
  std::uint16_t warning_ = 0;
  bool life_ = false;  ///< status bit 14
  canopen::Duration since_life_{};
};

}  // namespace simulator
