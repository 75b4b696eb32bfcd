#include "simulator/opte6.h"

#include <cmath>
#include <utility>

#include "simulator/drive.h"
#include "simulator/readings.h"

namespace simulator {
namespace {

constexpr std::uint16_t kParameters = 0x2100;  ///< plus the application ID
/// Scaling modes of 0x2005. The manual gives the object and what it is for, not its values: these are the simulator's.
constexpr std::uint8_t kScalingNx = 0;
constexpr std::uint8_t kScalingRaw = 1;
/// What the drive calls a fieldbus fault. The simulator's choice, after the Vacon drives' usual number.
constexpr std::uint16_t kFieldbusFault = 53;

Traits opte6_traits() {
  Traits traits;
  traits.device_type = 0x00010192;  // CiA 402, frequency converter
  traits.device_name = "Vacon drive with OPTE6 (simulated)";
  traits.identity = {0x90, 0, 0, 0};  // vendor as shown by a sibling board
  traits.error_history = true;
  traits.sync_counter = true;
  traits.emergency_counts_sources = true;
  traits.node_guarding = true;
  traits.heartbeat_consumers = 4;
  traits.error_behaviour = true;
  traits.keeps_settings_on_reset_communication = true;
  PdoRules& pdo = traits.pdo;
  // The default mapping is not known, so there is none here: a master has to write it.
  pdo.transmit = std::vector<PdoDefaults>(3);
  pdo.receive = std::vector<PdoDefaults>(3);
  pdo.pre_operational_only = true;
  pdo.strict_procedure = true;
  pdo.sync_start_value = true;
  pdo.rpdo_deadline = true;
  pdo.triggers = standard_triggers;
  return traits;
}

}  // namespace

Opte6::Opte6() : traits_(opte6_traits()) {}

void Opte6::start(Drive& drive) {
  drive_ = &drive;
  velocity_.emplace(drive.motor(), drive.record());
  target_ = 0;
  mode_ = kScalingNx;
  fault_ = 0;
  warning_ = 0;
  define_velocity_mode();
  define_monitoring();
}

void Opte6::define_velocity_mode() {
  ObjectDictionary& dictionary = drive_->dictionary();
  Object control;
  control.mappable = Mappable::both;
  control.read = [this] { return velocity_->controlword(); };
  control.write = [this](std::uint32_t value) {
    if (velocity_->control(static_cast<std::uint16_t>(value))) {
      clear_faults();
    }
    return Abort::none;
  };
  dictionary.add({0x6040, 0}, std::move(control));
  dictionary.add_reading(
      {0x6041, 0}, 2, [this] { return velocity_->statusword(warning_ != 0, drive_->misbehaviour().local); },
      Mappable::transmit);
  Object target;
  target.mappable = Mappable::both;
  target.read = [this] { return target_; };
  target.write = [this](std::uint32_t value) {
    target_ = static_cast<std::uint16_t>(value);
    velocity_->set_target_rpm(static_cast<std::int16_t>(target_));
    return Abort::none;
  };
  dictionary.add({0x6042, 0}, std::move(target));
  dictionary.add_reading({0x6044, 0}, 2, [this] { return scaled(velocity_->actual_rpm(), 1); }, Mappable::transmit);
}

void Opte6::define_monitoring() {
  Object mode;
  mode.size = 1;
  mode.read = [this] { return mode_; };
  mode.write = [this](std::uint32_t value) {
    if (value > kScalingRaw) {
      return Abort::invalid_value;
    }
    mode_ = static_cast<std::uint8_t>(value);
    define_readings();  // Their width follows.
    return Abort::none;
  };
  drive_->dictionary().add({0x2005, 0}, std::move(mode));
  define_readings();
}

void Opte6::define_readings() {
  const Motor& motor = drive_->motor();
  // The width is not documented: 16 bits as the older NX drives have them, 32 bits for the raw values with 4 decimals.
  const auto reading = [&](std::uint16_t id, std::function<double()> value, double nx_scale, bool has_raw_form) {
    const bool raw = has_raw_form && mode_ == kScalingRaw;
    const double scale = raw ? 10000.0 : nx_scale;
    drive_->dictionary().add_reading({static_cast<std::uint16_t>(kParameters + id), 0}, raw ? 4 : 2,
                                     [value = std::move(value), scale] { return scaled(value(), scale); });
  };
  reading(1, [&motor] { return std::abs(motor.output_hz()); }, 100, true);
  reading(2, [&motor] { return motor.shaft_rpm(); }, 1, true);
  reading(3, [&motor] { return motor.current_a(); }, 10, true);
  reading(4, [&motor] { return motor.torque_percent(); }, 10, false);
  reading(5, [&motor] { return motor.power_percent(); }, 10, false);
  reading(6, [&motor] { return motor.output_v(); }, 10, true);
  reading(7, [&motor] { return motor.dc_bus_v(); }, 1, true);
  reading(37, [this] { return fault_; }, 1, false);
}

void Opte6::step(canopen::Duration /*passed*/) {
  velocity_->step();
}

void Opte6::raise_fault(std::uint16_t code) {
  if (code == 0) {
    return;
  }
  fault_ = code;
  velocity_->trip();
  // An internal fault is always 0x1000; where its own number stands is not documented: little-endian from byte 3 here.
  EmergencyMessage message{0x1000, 0x01, {}};
  message.vendor = {static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8U)};
  drive_->emergency().raise(ErrorSource::drive, message);
}

void Opte6::clear_faults() {
  fault_ = 0;
  warning_ = 0;
  velocity_->reset_fault();
  drive_->emergency().clear(ErrorSource::drive);
}

void Opte6::on_connection_lost(ConnectionLoss /*loss*/) {
  raise_fault(kFieldbusFault);
}

}  // namespace simulator
