#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/modbus/site.h"

namespace modbus_test {
namespace {

using canopen::DataType;
using config::Access;
using config::ModbusKind;
using config::Signal;
using config::SourceKind;
using std::chrono::milliseconds;

constexpr std::uint8_t kNode = 5;
constexpr canopen::ObjectAddress kStatusObject{0x2010, 1};
constexpr canopen::ObjectAddress kOutputFrequencyObject{0x2010, 2};
constexpr canopen::ObjectAddress kPositionObject{0x2010, 3};
constexpr canopen::ObjectAddress kTemperatureObject{0x2011, 1};
constexpr canopen::ObjectAddress kPowerObject{0x2011, 2};
constexpr canopen::ObjectAddress kSpeedObject{0x2011, 3};

Signal measured(std::string name, canopen::ObjectAddress object, DataType type, std::uint16_t tpdo,
                config::ModbusPlace place) {
  Signal signal;
  signal.name = std::move(name);
  signal.object = object;
  signal.type = type;
  signal.source = {.kind = SourceKind::tpdo, .number = tpdo};
  signal.modbus = place;
  return signal;
}

Signal derived(std::string name, std::uint64_t mask, std::uint16_t address) {
  Signal signal = measured(std::move(name), kStatusObject, DataType::boolean, 1, {ModbusKind::bit, address, 1, false});
  signal.derived = config::Derived{.from = 0, .mask = mask, .values = {mask}};
  return signal;
}

Signal command(std::string name, canopen::ObjectAddress object, DataType type, config::Source source,
               config::ModbusPlace place) {
  Signal signal = measured(std::move(name), object, type, 0, place);
  signal.access = Access::write;
  signal.source = source;
  return signal;
}

constexpr config::Source kSdo{SourceKind::sdo, 0};
constexpr config::Source kRpdo1{SourceKind::rpdo, 1};

config::ModbusPlace at(std::uint16_t where, std::uint16_t count = 1, bool as_float = false) {
  return {.kind = ModbusKind::holding, .address = where, .count = count, .as_float = as_float};
}

std::vector<Signal> signals() {
  std::vector<Signal> all{
      measured("status_word", kStatusObject, DataType::u16, 1, at(address::kStatusWord)),
      measured("output_frequency", kOutputFrequencyObject, DataType::i16, 1, at(address::kFrequency)),
      measured("position", kPositionObject, DataType::i32, 1, at(address::kPosition, 2)),
      measured("temperature", kTemperatureObject, DataType::i8, 2, at(address::kTemperature)),
      measured("power", kPowerObject, DataType::f32, 2, at(address::kPower, 2)),
      measured("speed", kSpeedObject, DataType::u16, 2, at(address::kSpeedFloat, 2, true)),
      derived("running", 0x0001, 0),
      derived("fault", 0x0008, 2),
      command("control_command", kControlObject, DataType::u16, kRpdo1, at(address::kControlCommand)),
      command("frequency_command", kFrequencyObject, DataType::u16, kRpdo1, at(address::kFrequencyCommand)),
      command("acceleration", kAccelerationObject, DataType::u16, kSdo, at(address::kAcceleration)),
      command("target_position", kTargetObject, DataType::i32, kSdo, at(address::kTargetPosition, 2)),
      command("limit", kLimitObject, DataType::u16, kSdo, at(address::kLimitFloat, 2, true)),
      command("jog_speed", kJogObject, DataType::i8, kSdo, at(address::kJogSpeed)),
      command("ramp", kRampObject, DataType::u16, kSdo, at(address::kRamp)),
      command("relay", kRelayObject, DataType::boolean, kSdo, {ModbusKind::bit, 10, 1, false}),
      command("valve", kValveObject, DataType::boolean, kSdo, {ModbusKind::bit, 11, 1, false}),
  };
  all[1].scale = 0.01;
  all[5].scale = 0.1;
  all[8].momentary = {0x80};
  all[9].scale = 0.01;
  all[9].min = 0.0;
  all[9].max = 50.0;
  all[12].scale = 0.01;
  all[12].max = 49.97;
  all[14].access = Access::read_write;
  return all;
}

canopen::NodeSettings node_settings() {
  canopen::NodeSettings node;
  node.node = kNode;
  node.error_control.policy = canopen::SetupPolicy::assume;
  canopen::PdoSettings fast;
  fast.number = 1;
  fast.cob_id = 0x180U + kNode;
  fast.mapping_policy = canopen::SetupPolicy::assume;
  fast.transmission_type = 254;
  fast.event_timer = 100;
  fast.period = milliseconds(100);
  fast.mapping = {{kStatusObject, DataType::u16, 16},
                  {kOutputFrequencyObject, DataType::i16, 16},
                  {kPositionObject, DataType::i32, 32}};
  canopen::PdoSettings slow;
  slow.number = 2;
  slow.cob_id = 0x280U + kNode;
  slow.communication = canopen::SetupPolicy::assume;
  slow.mapping_policy = canopen::SetupPolicy::assume;
  slow.mapping = {
      {kTemperatureObject, DataType::i8, 8}, {kPowerObject, DataType::f32, 32}, {kSpeedObject, DataType::u16, 16}};
  node.tpdos = {fast, slow};
  canopen::PdoSettings receive;
  receive.number = 1;
  receive.cob_id = 0x200U + kNode;
  receive.communication = canopen::SetupPolicy::assume;
  receive.mapping_policy = canopen::SetupPolicy::assume;
  receive.mapping = {{kControlObject, DataType::u16, 16}, {kFrequencyObject, DataType::u16, 16}};
  node.rpdos = {receive};
  return node;
}

}  // namespace

config::Model example_model() {
  config::Model model;
  model.gateway.name = "line3";
  model.buses = {config::Bus{.name = "can0", .interface = "virtual", .bitrate = 250000, .heartbeat = {}}};
  config::Drive drive;
  drive.name = "pump1";
  drive.unit = kUnit;
  drive.node = node_settings();
  drive.signals = signals();
  drive.faults.running = 6;
  drive.faults.fault = 7;
  drive.faults.has_error_register = false;
  drive.faults.has_error_field = false;
  drive.commands.writers.modbus = true;
  model.drives = {drive};
  model.modbus = config::Modbus{};
  model.modbus->listen = {{"127.0.0.1", 0}};
  return model;
}

void fill_dictionary(support::Puppet& puppet) {
  puppet.dictionary = {{{0x1800, 1}, {0x180U + kNode, 4}},
                       {{0x1800, 2}, {254, 1}},
                       {{0x1800, 5}, {100, 2}},
                       {{0x1017, 0}, {500, 2}},
                       {kStatusObject, {0, 2}},
                       {kOutputFrequencyObject, {0, 2}},
                       {kPositionObject, {0, 4}},
                       {kTemperatureObject, {0, 1}},
                       {kPowerObject, {0, 4}},
                       {kSpeedObject, {0, 2}},
                       {kControlObject, {0, 2}},
                       {kFrequencyObject, {0, 2}},
                       {kAccelerationObject, {0, 2}},
                       {kTargetObject, {0, 4}},
                       {kLimitObject, {0, 2}},
                       {kJogObject, {0, 1}},
                       {kRampObject, {7, 2}},
                       {kRelayObject, {0, 1}},
                       {kValveObject, {0, 1}}};
}

}  // namespace modbus_test
