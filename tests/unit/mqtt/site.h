#pragma once

#include <string>
#include <utility>

#include "config/model.h"

// A small plant to test with: drive `pump1`, node 5, with one signal of each shape.

namespace mqtt::test {

// Named like the constants that they are used as.  NOLINTBEGIN(readability-identifier-naming)
enum SignalPosition : std::size_t {
  kStatusWord,
  kFrequency,
  kState,
  kFaultCode,
  kRunning,
  kFrequencyCommand,
  kControlCommand,
  kCounter,
  kMode,
  kSwitch
};
// NOLINTEND(readability-identifier-naming)

inline config::Signal signal(std::string name, std::uint16_t index, std::uint8_t sub, canopen::DataType type,
                             config::Access access, config::Source source) {
  config::Signal made;
  made.name = std::move(name);
  made.object = {index, sub};
  made.type = type;
  made.access = access;
  made.source = source;
  return made;
}

inline config::Drive pump1() {
  using canopen::DataType;
  using config::Access;
  constexpr config::Source kTpdo{config::SourceKind::tpdo, 1};
  constexpr config::Source kRpdo{config::SourceKind::rpdo, 1};
  constexpr config::Source kSdo{config::SourceKind::sdo, 0};

  config::Drive drive;
  drive.name = "pump1";
  drive.profile = "test";
  drive.unit = std::uint8_t{5};
  drive.node.node = 5;
  drive.commands.writers.mqtt = true;
  drive.signals = {signal("status_word", 0x2021, 1, DataType::u16, Access::read, kTpdo),
                   signal("output_frequency", 0x2021, 2, DataType::u16, Access::read, kTpdo),
                   signal("drive_state", 0x2021, 3, DataType::u8, Access::read, kTpdo),
                   signal("fault_code", 0x2021, 4, DataType::u16, Access::read, kTpdo),
                   signal("running", 0x2021, 1, DataType::u16, Access::read, kTpdo),
                   signal("frequency_command", 0x2000, 2, DataType::u16, Access::write, kRpdo),
                   signal("control_command", 0x2000, 1, DataType::u16, Access::write, kRpdo),
                   signal("energy", 0x2030, 0, DataType::u64, Access::read_write, kSdo),
                   signal("mode", 0x2031, 0, DataType::u8, Access::read_write, kSdo),
                   signal("brake", 0x2032, 0, DataType::boolean, Access::read_write, kSdo)};
  drive.signals[kStatusWord].publish_mask = 0x7FFF;
  drive.signals[kFrequency].scale = 0.01;
  drive.signals[kFrequency].decimals = 2;
  drive.signals[kFrequency].unit = "Hz";
  drive.signals[kState].values = {{3, "stopped"}, {4, "running"}};
  drive.signals[kFaultCode].values = {{5, "overcurrent"}};
  drive.signals[kRunning].derived = config::Derived{.from = kStatusWord, .mask = 0x0001, .values = {1}};
  drive.signals[kFrequencyCommand].scale = 0.01;
  drive.signals[kFrequencyCommand].decimals = 2;
  drive.signals[kFrequencyCommand].min = 0.0;
  drive.signals[kFrequencyCommand].max = 50.0;
  drive.signals[kMode].values = {{0, "speed"}, {1, "torque"}};
  drive.faults.fault_code = kFaultCode;
  drive.faults.running = kRunning;

  canopen::PdoSettings tpdo;
  tpdo.cob_id = 0x185;
  tpdo.communication = canopen::SetupPolicy::assume;
  tpdo.mapping_policy = canopen::SetupPolicy::assume;
  tpdo.period = std::chrono::milliseconds(100);
  tpdo.mapping = {{{0x2021, 1}, DataType::u16, 16},
                  {{0x2021, 2}, DataType::u16, 16},
                  {{0x2021, 3}, DataType::u8, 8},
                  {{0x2021, 4}, DataType::u16, 16}};
  canopen::PdoSettings rpdo;
  rpdo.cob_id = 0x205;
  rpdo.communication = canopen::SetupPolicy::assume;
  rpdo.mapping_policy = canopen::SetupPolicy::assume;
  rpdo.mapping = {{{0x2000, 1}, DataType::u16, 16}, {{0x2000, 2}, DataType::u16, 16}};
  drive.node.tpdos = {tpdo};
  drive.node.rpdos = {rpdo};
  return drive;
}

inline config::Model model() {
  config::Model made;
  made.gateway.name = "line3";
  config::Bus bus;
  bus.name = "can0";
  bus.interface = "virtual";
  made.buses = {bus};
  made.drives = {pump1()};
  made.mqtt = config::Mqtt{};
  return made;
}

}  // namespace mqtt::test
