#include "simulator/veichi.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "simulator/drive.h"
#include "simulator/readings.h"
#include "simulator/veichi_tables.h"

namespace simulator {
namespace {

constexpr double kVeichiJogHz = 5.0;
constexpr canopen::Duration kLifeBitPeriod = std::chrono::milliseconds(500);

/// The manual's table of control commands is empty. These codes are the simulator's own choice, so that there is
/// something to play with; they say nothing about a real drive.
enum class Command : std::uint16_t {
  none = 0,
  forward = 1,
  reverse = 2,
  jog_forward = 3,
  jog_reverse = 4,
  stop = 5,
  coast = 6,
  fault_reset = 7
};

}  // namespace

Veichi::Veichi(VeichiSeries series, const DriveOptions& options)
    : series_(series), options_(options), traits_(veichi_traits(options.veichi_pdo_objects)) {
  const auto highest = static_cast<std::uint16_t>(scaled(options_.motor.max_hz, 100));
  stored_[series_ == VeichiSeries::ac300 ? 0x0009 : 0x010A] = highest;  // F00.09, F01.10; the unit is the simulator's
  if (series_ == VeichiSeries::ac300) {
    stored_[0x0D02] = 30;  // F13.02: tens digit 3 is 125 kbit/s, the default
    stored_[0x0002] = options_.veichi_bus_control ? 2 : 0;
    stored_[0x0003] = options_.veichi_bus_control ? 6 : 0;
  } else {
    stored_[0x0C2A] = 3;  // F12.42
    stored_[0x0101] = options_.veichi_bus_control ? 3 : 0;
    stored_[0x0102] = options_.veichi_bus_control ? 10 : 0;
  }
}

std::string_view Veichi::kind() const {
  return series_ == VeichiSeries::ac300 ? "veichi-ac300" : "veichi-ac310";
}

void Veichi::start(Drive& drive) {
  drive_ = &drive;
  stored_[series_ == VeichiSeries::ac300 ? 0x0D0C : 0x0C29] = drive.node();  // F13.12, F12.41
  parameters_ = stored_;
  frequency_ = 0;
  upper_limit_ = static_cast<std::uint16_t>(scaled(drive.motor().rating().max_hz, 100));
  jogging_ = false;
  fault_ = 0;
  warning_ = 0;
  define_parameters();
  define_control_block();
  define_monitoring();
}

void Veichi::define_parameters() {
  ObjectDictionary& dictionary = drive_->dictionary();
  dictionary.set_fallback([this](Address address) { return parameter_object(address); });
  // One of each group, so that an absent sub-index is told from an absent index.
  for (const auto& [first, last] : {std::pair{0x2000, 0x201F}, {0x20A0, 0x20AF}, {0x20F0, 0x20FF}}) {
    for (int index = first; index <= last; ++index) {
      static_cast<void>(dictionary.find({static_cast<std::uint16_t>(index), 1}));
    }
  }
}

std::optional<Object> Veichi::parameter_object(Address address) {
  const auto place = veichi_parameter(address);
  if (!place) {
    return std::nullopt;
  }
  Object object;
  object.read = [this, parameter = place->parameter] {
    const auto found = parameters_.find(parameter);
    return found == parameters_.end() ? 0U : std::uint32_t{found->second};
  };
  object.write = [this, place = *place](std::uint32_t value) {
    parameters_[place.parameter] = static_cast<std::uint16_t>(value);
    if (place.stored) {
      stored_[place.parameter] = static_cast<std::uint16_t>(value);
      ++drive_->record().eeprom_writes;
    }
    return Abort::none;
  };
  return object;
}

void Veichi::define_control_block() {
  ObjectDictionary& dictionary = drive_->dictionary();
  const auto writable = [&](std::uint8_t sub, Access access, std::function<Abort(std::uint32_t)> write) -> Object& {
    Object object;
    object.access = access;
    object.mappable = Mappable::receive;
    object.write = std::move(write);
    return dictionary.add({kVeichiControlBlock, sub}, std::move(object));
  };
  writable(1, Access::write_only, [this](std::uint32_t value) { return set_frequency(value); });
  writable(2, Access::write_only, [this](std::uint32_t value) { return command(value); });
  dictionary.add_reading({kVeichiControlBlock, 3}, 2, [this] { return status(); }, Mappable::transmit);
  dictionary.add_reading(
      {kVeichiControlBlock, 4}, 2, [this] { return fault_ != 0 ? fault_ : warning_; }, Mappable::transmit);
  Object& limit = writable(5, Access::read_write, [this](std::uint32_t value) {
    upper_limit_ = static_cast<std::uint16_t>(value);
    apply_target();
    return Abort::none;
  });
  limit.read = [this] { return upper_limit_; };
  // Torque control is not simulated: these three are kept and change nothing.
  writable(6, Access::write_only, nullptr);
  writable(7, Access::read_write, nullptr);
  writable(8, Access::read_write, nullptr);
}

void Veichi::define_monitoring() {
  ObjectDictionary& dictionary = drive_->dictionary();
  Motor& motor = drive_->motor();
  const auto reading = [&](std::uint8_t number, std::function<std::uint32_t()> read) {
    const auto sub = static_cast<std::uint8_t>(number + 1);
    dictionary.add_reading({kVeichiMonitoring, sub}, 2, std::move(read), Mappable::transmit);
  };
  reading(1, [&motor] { return scaled(std::abs(motor.output_hz()), 100); });
  reading(2, [&motor] { return scaled(motor.current_a(), 10); });
  reading(3, [&motor] { return scaled(motor.input_v(), 10); });
  reading(4, [&motor] { return scaled(motor.output_v(), 10); });
  reading(5, [&motor] { return scaled(std::abs(motor.shaft_rpm()), 1); });
  reading(7, [&motor] { return scaled(motor.torque_percent(), 10); });
  reading(10, [&motor] { return scaled(motor.power_percent(), 10); });
  reading(11, [&motor] { return scaled(motor.dc_bus_v(), 10); });
  reading(12, [&motor] { return scaled(motor.temperature_c(), 10); });
  reading(26, [&motor] { return scaled(motor.rating().rated_v, 1); });
}

bool Veichi::obeys_bus_commands() const {
  return series_ == VeichiSeries::ac300 ? parameters_.at(0x0002) == 2 : parameters_.at(0x0101) == 3;
}

bool Veichi::obeys_bus_frequency() const {
  return series_ == VeichiSeries::ac300 ? parameters_.at(0x0003) == 6 : parameters_.at(0x0102) == 10;
}

Abort Veichi::command(std::uint32_t code) {
  if (code > static_cast<std::uint32_t>(Command::fault_reset)) {
    return Abort::invalid_value;
  }
  const auto command = static_cast<Command>(code);
  if (command == Command::fault_reset) {
    clear_faults();
    return Abort::none;
  }
  if (!obeys_bus_commands()) {
    return Abort::none;  // Taken in, but the panel or the terminals command.
  }
  Motor& motor = drive_->motor();
  switch (command) {
    case Command::forward:
    case Command::reverse:
    case Command::jog_forward:
    case Command::jog_reverse:
      if (fault_ == 0) {
        ++drive_->record().run_commands;
        jogging_ = command == Command::jog_forward || command == Command::jog_reverse;
        apply_target();
        motor.run(command == Command::reverse || command == Command::jog_reverse);
      }
      break;
    case Command::stop:
      motor.stop();
      break;
    case Command::coast:
      motor.coast();
      break;
    case Command::none:
    case Command::fault_reset:
      break;
  }
  return Abort::none;
}

Abort Veichi::set_frequency(std::uint32_t hundredths) {
  if (hundredths > scaled(drive_->motor().rating().max_hz, 100)) {
    return Abort::invalid_value;
  }
  if (obeys_bus_frequency()) {
    frequency_ = static_cast<std::uint16_t>(hundredths);
    apply_target();
  }
  return Abort::none;
}

void Veichi::apply_target() {
  drive_->motor().set_target(jogging_ ? kVeichiJogHz : std::min(frequency_, upper_limit_) / 100.0);
}

std::uint16_t Veichi::status() const {
  const Motor& motor = drive_->motor();
  unsigned word = 0;
  const auto set = [&word](unsigned bit, bool on) { word |= on ? 1U << bit : 0U; };
  set(0, motor.output_on());
  set(1, motor.output_on() && motor.accelerating());
  set(2, motor.output_on() && motor.decelerating());
  set(3, motor.reverse());
  set(4, fault_ != 0);
  set(6, warning_ != 0);
  set(7, fault_ == 0);
  set(14, life_);
  return static_cast<std::uint16_t>(word);
}

void Veichi::step(canopen::Duration passed) {
  since_life_ += passed;
  if (since_life_ >= kLifeBitPeriod) {
    since_life_ -= kLifeBitPeriod;
    life_ = !life_;
  }
}

void Veichi::raise_fault(std::uint16_t code) {
  if (code == 0) {
    return;
  }
  fault_ = code;
  drive_->motor().coast();
  // Bytes 0-1 and 3-7 both hold the drive's code; register: the error bit.
  const auto low = static_cast<std::uint8_t>(code);
  const auto high = static_cast<std::uint8_t>(code >> 8U);
  drive_->emergency().raise(ErrorSource::drive, {code, 0x01, {low, high}});
}

void Veichi::raise_warning(std::uint16_t code) {
  warning_ = code;
}

void Veichi::clear_faults() {
  fault_ = 0;
  warning_ = 0;
  drive_->emergency().clear(ErrorSource::drive);
}

AnswerStyle Veichi::answer_style(Address address, bool write) const {
  AnswerStyle style;
  if (address.index >= 0x2000 && address.index <= 0x201F) {
    style.upload_for_write = write;  // Example 3 of §3.1.4.
  } else if (address.index >= kVeichiMonitoring && address.index <= kVeichiControlBlock) {
    style.trimmed = true;  // Examples 4 and 5 of §3.1.4.
  }
  return style;
}

}  // namespace simulator
