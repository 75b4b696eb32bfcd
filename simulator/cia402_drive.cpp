#include "simulator/cia402_drive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulator/drive.h"
#include "simulator/readings.h"

namespace simulator {
namespace {

constexpr std::uint32_t kVelocityMode = 2;  ///< 6060

Traits cia402_traits() {
  Traits traits;
  traits.device_type = 0x00010192;
  traits.device_name = "Simulated CiA 402 frequency converter";
  traits.identity = {0x0000FFFF, 402, 0x00010000, 1};
  traits.error_history = true;
  traits.sync_counter = true;
  traits.node_guarding = true;
  traits.heartbeat_consumers = 2;
  traits.error_behaviour = true;
  PdoRules& pdo = traits.pdo;
  const std::uint32_t control = map_value(0x6040, 0, 16);
  const std::uint32_t status = map_value(0x6041, 0, 16);
  // CiA 402-3: PDO1, PDO2 and, without a predefined COB-ID, PDO6.
  pdo.receive = std::vector<PdoDefaults>(6, {false, 255, 0, 0, {}});
  pdo.receive[0] = {true, 255, 0, 0, {control}};
  pdo.receive[1] = {true, 255, 0, 0, {control, map_value(0x6060, 0, 8)}};
  pdo.receive[5].map = {control, map_value(0x6042, 0, 16)};
  pdo.transmit = std::vector<PdoDefaults>(6, {false, 255, 0, 0, {}});
  pdo.transmit[0] = {true, 255, 0, 0, {status}};
  pdo.transmit[1] = {true, 255, 0, 0, {status, map_value(0x6061, 0, 8)}};
  pdo.transmit[5].map = {status, map_value(0x6044, 0, 16)};
  pdo.strict_procedure = true;
  pdo.sync_start_value = true;
  pdo.rpdo_deadline = true;
  pdo.triggers = standard_triggers;
  return traits;
}

/// Error register bits by the class of the code (CiA 301 tables 21 and 26).
std::uint8_t register_bits(std::uint16_t code) {
  switch (code >> 12U) {
    case 2:
      return 0x03;
    case 3:
      return 0x05;
    case 4:
      return 0x09;
    case 8:
      return 0x11;
    default:
      return 0x01;
  }
}

Object number(std::uint8_t size, std::function<std::uint32_t()> read, std::function<Abort(std::uint32_t)> write,
              Mappable mappable = Mappable::no) {
  Object object;
  object.size = size;
  object.mappable = mappable;
  object.read = std::move(read);
  object.write = std::move(write);
  return object;
}

/// An option code of which only some values are known.
Object choice(std::function<std::uint32_t()> read, std::uint32_t greatest, std::function<void(std::uint32_t)> store) {
  return number(2, std::move(read), [greatest, store = std::move(store)](std::uint32_t value) {
    if (value > greatest) {
      return Abort::invalid_value;
    }
    store(value);
    return Abort::none;
  });
}

}  // namespace

Cia402Drive::Cia402Drive() : traits_(cia402_traits()) {}

void Cia402Drive::start(Drive& drive) {
  drive_ = &drive;
  velocity_.emplace(drive.motor(), drive.record());
  target_ = 0;
  amounts_ = {0, static_cast<std::uint32_t>(std::lround(velocity_->highest_rpm()))};
  acceleration_ = {};
  deceleration_ = {};
  quick_stop_ = {};
  set_point_factor_ = {};
  dimension_factor_ = {};
  abort_connection_ = 1;
  fault_ = 0;
  warning_ = 0;
  define_control();
  define_velocity();
  define_options();
  // A writable string, for segmented downloads; the simulator's own object.
  Object label;
  label.size = 0;
  drive.dictionary().add({0x2F00, 0}, std::move(label));
  apply();
}

void Cia402Drive::apply() {
  const double hz_per_rpm = drive_->motor().rating().pole_pairs / 60.0;
  drive_->motor().set_ramps(acceleration_.rpm_s() * hz_per_rpm, deceleration_.rpm_s() * hz_per_rpm);
  velocity_->options().quick_stop_hz_s = quick_stop_.rpm_s() * hz_per_rpm;
  velocity_->set_amounts(amounts_[0], amounts_[1]);
  velocity_->set_target_rpm(static_cast<std::int16_t>(target_) / units_per_rpm());
}

double Cia402Drive::units_per_rpm() const noexcept {
  return 1.0 / (set_point_factor_.value() * dimension_factor_.value());
}

void Cia402Drive::define_control() {
  ObjectDictionary& dictionary = drive_->dictionary();
  dictionary.add({0x6040, 0}, number(
                                  2, [this] { return velocity_->controlword(); },
                                  [this](std::uint32_t value) {
                                    if (velocity_->control(static_cast<std::uint16_t>(value))) {
                                      clear_faults();
                                    }
                                    return Abort::none;
                                  },
                                  Mappable::both));
  dictionary.add_reading(
      {0x6041, 0}, 2, [this] { return velocity_->statusword(warning_ != 0, drive_->misbehaviour().local); },
      Mappable::transmit);
  dictionary.add_reading({0x603F, 0}, 2, [this] { return fault_; }, Mappable::transmit);
  dictionary.add({0x6060, 0},
                 number(
                     1, [] { return kVelocityMode; },
                     [](std::uint32_t value) { return value == kVelocityMode ? Abort::none : Abort::invalid_value; },
                     Mappable::both));
  dictionary.add_reading({0x6061, 0}, 1, [] { return kVelocityMode; }, Mappable::transmit);
  dictionary.add_constant({0x6502, 0}, 4, 1U << 1U);  // vl and nothing else
}

void Cia402Drive::define_velocity() {
  ObjectDictionary& dictionary = drive_->dictionary();
  dictionary.add({0x6042, 0}, number(
                                  2, [this] { return target_; },
                                  [this](std::uint32_t value) {
                                    target_ = static_cast<std::uint16_t>(value);
                                    apply();
                                    return Abort::none;
                                  },
                                  Mappable::both));
  dictionary.add_reading(
      {0x6043, 0}, 2, [this] { return scaled(velocity_->demand_rpm(), units_per_rpm()); }, Mappable::transmit);
  dictionary.add_reading(
      {0x6044, 0}, 2, [this] { return scaled(velocity_->actual_rpm(), units_per_rpm()); }, Mappable::transmit);
  dictionary.add_constant({0x6046, 0}, 1, 2);
  for (std::size_t i = 0; i < amounts_.size(); ++i) {
    dictionary.add({0x6046, static_cast<std::uint8_t>(i + 1)}, number(
                                                                   4, [this, i] { return amounts_[i]; },
                                                                   [this, i](std::uint32_t value) {
                                                                     amounts_[i] = value;
                                                                     apply();
                                                                     return Abort::none;
                                                                   }));
  }
  define_ramp(0x6048, acceleration_);
  define_ramp(0x6049, deceleration_);
  define_ramp(0x604A, quick_stop_);
  define_fraction(0x604B, 2, set_point_factor_);
  define_fraction(0x604C, 4, dimension_factor_);
}

void Cia402Drive::define_ramp(std::uint16_t index, Ramp& ramp) {
  ObjectDictionary& dictionary = drive_->dictionary();
  dictionary.add_constant({index, 0}, 1, 2);
  dictionary.add({index, 1}, number(
                                 4, [&ramp] { return ramp.delta_speed; },
                                 [this, &ramp](std::uint32_t value) {
                                   if (value == 0) {
                                     return Abort::invalid_value;
                                   }
                                   ramp.delta_speed = value;
                                   apply();
                                   return Abort::none;
                                 }));
  dictionary.add({index, 2}, number(
                                 2, [&ramp] { return ramp.delta_time; },
                                 [this, &ramp](std::uint32_t value) {
                                   if (value == 0) {
                                     return Abort::invalid_value;
                                   }
                                   ramp.delta_time = static_cast<std::uint16_t>(value);
                                   apply();
                                   return Abort::none;
                                 }));
}

void Cia402Drive::define_fraction(std::uint16_t index, std::uint8_t size, Fraction& fraction) {
  ObjectDictionary& dictionary = drive_->dictionary();
  dictionary.add_constant({index, 0}, 1, 2);
  const auto part = [this, size](std::int32_t& value) {
    return number(
        size, [&value] { return static_cast<std::uint32_t>(value); },
        [this, size, &value](std::uint32_t written) {
          const std::int32_t sign = size == 2 ? static_cast<std::int16_t>(written) : static_cast<std::int32_t>(written);
          if (sign == 0) {
            return Abort::invalid_value;
          }
          value = sign;
          apply();
          return Abort::none;
        });
  };
  dictionary.add({index, 1}, part(fraction.numerator));
  dictionary.add({index, 2}, part(fraction.denominator));
}

void Cia402Drive::define_options() {
  ObjectDictionary& dictionary = drive_->dictionary();
  VelocityOptions& options = velocity_->options();
  dictionary.add({0x605A, 0}, choice([&options] { return options.quick_stop_coasts ? 0U : 2U; }, 2,
                                     [&options](std::uint32_t value) { options.quick_stop_coasts = value == 0; }));
  dictionary.add({0x605B, 0}, choice([&options] { return options.shutdown_ramps ? 1U : 0U; }, 1,
                                     [&options](std::uint32_t value) { options.shutdown_ramps = value == 1; }));
  dictionary.add({0x605C, 0}, choice([&options] { return options.disable_ramps ? 1U : 0U; }, 1,
                                     [&options](std::uint32_t value) { options.disable_ramps = value == 1; }));
  dictionary.add_constant({0x605D, 0}, 2, 1);  // halt: ramp down and stay enabled
  dictionary.add_constant({0x605E, 0}, 2, 0);  // fault: coast
  dictionary.add({0x6007, 0},
                 choice([this] { return static_cast<std::uint32_t>(abort_connection_); }, 3,
                        [this](std::uint32_t value) { abort_connection_ = static_cast<std::int16_t>(value); }));
}

void Cia402Drive::step(canopen::Duration /*passed*/) {
  velocity_->step();
}

void Cia402Drive::raise_fault(std::uint16_t code) {
  if (code == 0) {
    return;
  }
  fault_ = code;
  velocity_->trip();
  drive_->emergency().raise(ErrorSource::drive, {code, register_bits(code), {}});
}

void Cia402Drive::clear_faults() {
  fault_ = 0;
  warning_ = 0;
  velocity_->reset_fault();
  drive_->emergency().clear(ErrorSource::drive);
}

void Cia402Drive::on_connection_lost(ConnectionLoss loss) {
  // The board has sent the EMCY; the drive only takes the code over.
  switch (abort_connection_) {
    case 1:
      fault_ = loss == ConnectionLoss::rpdo_deadline ? 0x8250 : 0x8130;
      velocity_->trip();
      break;
    case 2:
      velocity_->disable_voltage();
      break;
    case 3:
      velocity_->quick_stop();
      break;
    default:
      break;
  }
}

}  // namespace simulator
