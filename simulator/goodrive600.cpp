#include "simulator/goodrive600.h"

#include <cmath>
#include <utility>

#include "simulator/drive.h"
#include "simulator/goodrive600_tables.h"
#include "simulator/readings.h"

namespace simulator {
namespace {

constexpr std::uint8_t kFirstField = 3;  ///< sub-index of setting 1 and return 1
constexpr double kGoodriveJogHz = 5.0;
constexpr std::uint16_t kSetFrequency = 1;  ///< the only setting with an effect here

}  // namespace

Goodrive600::Goodrive600(const DriveOptions& options) : options_(options), traits_(goodrive600_traits()) {}

void Goodrive600::start(Drive& drive) {
  drive_ = &drive;
  settings_ = {};
  control_ = 0;
  frequency_hz_ = 0.0;
  jogging_ = false;
  request_ = {};
  answer_ = {};
  fault_ = 0;
  warning_ = 0;
  define_parameter_channel();
  define_process_data();
}

void Goodrive600::define_parameter_channel() {
  ObjectDictionary& dictionary = drive_->dictionary();
  for (std::size_t i = 0; i < request_.size(); ++i) {
    Object object;
    object.mappable = Mappable::receive;
    object.read = [this, i] { return request_[i]; };
    object.write = [this, i](std::uint32_t value) {
      request_[i] = static_cast<std::uint16_t>(value);
      return Abort::none;
    };
    dictionary.add({kGoodriveSettings, static_cast<std::uint8_t>(i)}, std::move(object));
  }
  dictionary.add_reading({kGoodriveReturns, 0}, 2, [this] { return answer_.response; }, Mappable::transmit);
  dictionary.add_reading({kGoodriveReturns, 1}, 2, [this] { return answer_.error; }, Mappable::transmit);
  dictionary.add_reading({kGoodriveReturns, 2}, 2, [this] { return answer_.data; }, Mappable::transmit);
}

void Goodrive600::define_process_data() {
  ObjectDictionary& dictionary = drive_->dictionary();
  for (std::size_t i = 0; i < kFields; ++i) {
    const auto sub = static_cast<std::uint8_t>(kFirstField + i);
    Object setting;
    setting.mappable = Mappable::receive;
    setting.read = [this, i] { return settings_[i]; };
    setting.write = [this, i](std::uint32_t value) {
      set(i, static_cast<std::uint16_t>(value));
      return Abort::none;
    };
    dictionary.add({kGoodriveSettings, sub}, std::move(setting));
    dictionary.add_reading({kGoodriveReturns, sub}, 2, [this, i] { return returned(i); }, Mappable::transmit);
  }
  Object control;
  control.mappable = Mappable::receive;
  control.read = [this] { return control_; };
  control.write = [this](std::uint32_t value) {
    control_ = static_cast<std::uint16_t>(value);
    command(control_);
    return Abort::none;
  };
  dictionary.add({kGoodriveControl, 0}, std::move(control));
  dictionary.add_reading({kGoodriveStatus, 0}, 2, [this] { return status(); }, Mappable::transmit);
}

void Goodrive600::command(std::uint16_t word) {
  Motor& motor = drive_->motor();
  // The whole word is a code; with anything in the high byte it is none.
  switch (word) {
    case 1:
    case 2:
    case 3:
    case 4:
      if (fault_ == 0) {
        ++drive_->record().run_commands;
        jogging_ = word >= 3;
        apply_target();
        motor.run(word == 2 || word == 4);
      }
      break;
    case 5:
    case 8:
      motor.stop();
      break;
    case 6:
      motor.coast();
      break;
    case 7:
      clear_faults();
      break;
    default:
      break;
  }
}

void Goodrive600::set(std::size_t field, std::uint16_t value) {
  settings_[field] = value;
  if (options_.goodrive_settings[field] == kSetFrequency) {
    frequency_hz_ = value / 100.0;
    apply_target();
  }
}

void Goodrive600::apply_target() {
  drive_->motor().set_target(jogging_ ? kGoodriveJogHz : frequency_hz_);
}

std::uint16_t Goodrive600::returned(std::size_t field) const {
  const Motor& motor = drive_->motor();
  const auto value = [&]() -> std::uint32_t {
    switch (options_.goodrive_returns[field]) {
      case 1:
        return scaled(std::abs(motor.output_hz()), 100);
      case 2:
        return scaled(frequency_hz_, 100);
      case 3:
        return scaled(motor.dc_bus_v(), 10);
      case 4:
        return scaled(motor.output_v(), 1);
      case 5:
        return scaled(motor.current_a(), 10);
      case 6:
        return scaled(motor.torque_percent(), 10);
      case 7:
        return scaled(motor.power_percent(), 10);
      case 8:
        return scaled(std::abs(motor.shaft_rpm()), 1);
      case 10:
        return scaled(std::abs(motor.ramp_hz()), 100);
      case 11:
        return fault_;
      default:
        return 0;  // invalid, or an input this drive has nothing wired to
    }
  };
  return static_cast<std::uint16_t>(value());
}

std::uint16_t Goodrive600::status() const {
  const Motor& motor = drive_->motor();
  unsigned word = 3;
  if (fault_ != 0) {
    word = 4;
  } else if (motor.output_on()) {
    word = motor.reverse() ? 2 : 1;
  }
  word |= 1U << 8U;  // bus voltage established
  word |= warning_ != 0 ? 1U << 12U : 0U;
  word |= 2U << 13U;  // controlled over communication
  return static_cast<std::uint16_t>(word);
}

void Goodrive600::on_rpdo(std::uint8_t number, const canopen::Frame& /*frame*/) {
  if (number == 1) {
    answer_ = access_parameter(request_[0], request_[1], request_[2]);
  }
}

std::uint16_t* Goodrive600::parameter(std::uint16_t address) {
  // P15.02..P15.12 choose the settings, P15.13..P15.23 the returns; the rest is not simulated.
  if (address >= 0x0F02 && address <= 0x0F0C) {
    return &options_.goodrive_settings[address - 0x0F02U];
  }
  if (address >= 0x0F0D && address <= 0x0F17) {
    return &options_.goodrive_returns[address - 0x0F0DU];
  }
  return nullptr;
}

Goodrive600::ParameterAnswer Goodrive600::access_parameter(std::uint16_t request, std::uint16_t address,
                                                           std::uint16_t data) {
  constexpr std::uint16_t kDone = 1;
  constexpr std::uint16_t kRefused = 3;
  if (request == 0) {
    return {};
  }
  // The sibling drives' codes: 1 reads, 2 writes.
  if (request > 2) {
    return {kRefused, 1, 0};
  }
  std::uint16_t* const value = parameter(address);
  if (value == nullptr) {
    return {kRefused, 2, 0};
  }
  if (request == 2) {
    if (drive_->motor().output_on()) {
      return {kRefused, 8, 0};
    }
    *value = data;
  }
  return {kDone, 0, *value};
}

void Goodrive600::raise_fault(std::uint16_t code) {
  if (code == 0) {
    return;
  }
  fault_ = code;
  drive_->motor().coast();
  EmergencyMessage message;
  // Only OUt1 is documented, and as a voltage error; the class of the others is the simulator's choice.
  constexpr std::uint16_t kOut1 = 1;
  message.code = code == kOut1 ? 0x3000 : 0x1000;
  message.error_register = code == kOut1 ? 0x04 : 0x01;
  message.vendor = {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8U)};
  drive_->emergency().raise(ErrorSource::drive, message);
}

void Goodrive600::raise_warning(std::uint16_t code) {
  warning_ = code;
}

void Goodrive600::clear_faults() {
  fault_ = 0;
  warning_ = 0;
  drive_->emergency().clear(ErrorSource::drive);
}

AnswerStyle Goodrive600::answer_style(Address /*address*/, bool write) const {
  AnswerStyle style;
  style.four_bytes = !write;
  return style;
}

}  // namespace simulator
