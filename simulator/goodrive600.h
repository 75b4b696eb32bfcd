#pragma once

#include <array>
#include <cstdint>

#include "simulator/model.h"
#include "simulator/options.h"

namespace simulator {

/// INVT Goodrive600 with its CANopen card.
class Goodrive600 final : public Model {
 public:
  explicit Goodrive600(const DriveOptions& options);

  [[nodiscard]] std::string_view kind() const override { return "invt-goodrive600"; }
  [[nodiscard]] const Traits& traits() const override { return traits_; }
  void start(Drive& drive) override;
  void step(canopen::Duration /*passed*/) override {}
  void raise_fault(std::uint16_t code) override;
  void raise_warning(std::uint16_t code) override;
  void clear_faults() override;
  [[nodiscard]] std::uint16_t fault() const override { return fault_; }
  [[nodiscard]] std::uint16_t warning() const override { return warning_; }
  void on_rpdo(std::uint8_t number, const canopen::Frame& frame) override;
  [[nodiscard]] AnswerStyle answer_style(Address address, bool write) const override;

 private:
  static constexpr std::size_t kFields = 11;

  struct ParameterAnswer {
    std::uint16_t response = 0;
    std::uint16_t error = 0;
    std::uint16_t data = 0;
  };

  void define_parameter_channel();
  void define_process_data();
  void command(std::uint16_t word);
  void set(std::size_t field, std::uint16_t value);
  void apply_target();
  [[nodiscard]] std::uint16_t returned(std::size_t field) const;
  [[nodiscard]] std::uint16_t status() const;
  [[nodiscard]] ParameterAnswer access_parameter(std::uint16_t request, std::uint16_t address, std::uint16_t data);
  [[nodiscard]] std::uint16_t* parameter(std::uint16_t address);

  DriveOptions options_;
  Traits traits_;
  Drive* drive_ = nullptr;
  std::array<std::uint16_t, kFields> settings_{};  ///< as received, 2100:03..0D
  std::uint16_t control_ = 0;                      ///< as received, 2101:00
  double frequency_hz_ = 0.0;
  bool jogging_ = false;
  std::array<std::uint16_t, 3> request_{};  ///< 2100:00..02
  ParameterAnswer answer_;                  ///< 2000:00..02
  std::uint16_t fault_ = 0;
  std::uint16_t warning_ = 0;
};

}  // namespace simulator
