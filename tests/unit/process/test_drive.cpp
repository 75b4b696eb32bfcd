#include "tests/unit/process/test_drive.h"

namespace process::test {

config::Signal word(std::string_view name, canopen::ObjectAddress object, canopen::DataType type, config::Source source,
                    config::Access access) {
  config::Signal signal;
  signal.name = name;
  signal.object = object;
  signal.type = type;
  signal.source = source;
  signal.access = access;
  return signal;
}

config::Signal bit(std::string_view name, std::size_t from, std::uint64_t mask) {
  config::Signal signal;
  signal.name = name;
  signal.type = canopen::DataType::boolean;
  signal.derived = config::Derived{from, mask, {mask}, false};
  return signal;
}

SignalId id(const config::Drive& model, std::string_view name) {
  return static_cast<SignalId>(model.find(name).value());
}

namespace {

void add_signals(config::Drive& drive) {
  using canopen::DataType;
  using config::Access;
  using config::SourceKind;
  drive.signals = {word("status_word", kStatusWord, DataType::u16, {SourceKind::tpdo, 1}),
                   word("output_frequency", kOutput, DataType::u16, {SourceKind::tpdo, 1}),
                   word("fault_code", kFaultCode, DataType::u16, {SourceKind::tpdo, 2}),
                   word("module_temperature", kTemperature, DataType::i16, {SourceKind::sdo, 0}),
                   word("upper_limit", kLimit, DataType::u16, {SourceKind::sdo, 0}, Access::read_write),
                   word("control_command", kControl, DataType::u16, {SourceKind::rpdo, 1}, Access::write),
                   word("frequency_command", kFrequency, DataType::u16, {SourceKind::rpdo, 1}, Access::write),
                   word("torque_command", kTorque, DataType::i16, {SourceKind::rpdo, 1}, Access::write)};
  drive.signals.push_back(bit("running", 0, kRunningBit));
  drive.signals.push_back(bit("reverse", 0, kReverseBit));
  drive.signals.push_back(bit("fault", 0, kFaultBit));
  drive.signals.push_back(bit("warning", 0, kWarningBit));
  const auto scale = [&](std::string_view name, double factor, unsigned decimals) {
    drive.signals[id(drive, name)].scale = factor;
    drive.signals[id(drive, name)].decimals = decimals;
  };
  scale("output_frequency", 0.01, 2);
  scale("frequency_command", 0.01, 2);
  scale("torque_command", 0.1, 1);
  scale("module_temperature", 0.1, 1);
  drive.signals[id(drive, "frequency_command")].min = 0.0;
  drive.signals[id(drive, "frequency_command")].max = 50.0;
  drive.signals[id(drive, "control_command")].momentary = {7};
  drive.signals[id(drive, "module_temperature")].poll = std::chrono::milliseconds(400);
  drive.signals[id(drive, "upper_limit")].poll = std::chrono::milliseconds(1000);
}

void add_pdos(config::Drive& drive) {
  using canopen::DataType;
  canopen::PdoSettings tpdo1{.number = 1, .cob_id = 0x185};
  tpdo1.communication = canopen::SetupPolicy::assume;
  tpdo1.mapping_policy = canopen::SetupPolicy::assume;
  tpdo1.mapping = {{kStatusWord}, {{0x2021, 3}}, {kOutput}};
  tpdo1.period = kPeriod;
  canopen::PdoSettings tpdo2 = tpdo1;
  tpdo2.number = 2;
  tpdo2.cob_id = 0x285;
  tpdo2.mapping = {{kFaultCode}};
  canopen::PdoSettings rpdo1 = tpdo1;
  rpdo1.cob_id = 0x205;
  rpdo1.period = {};
  rpdo1.mapping = {{kControl}, {kFrequency}, {kTorque, DataType::i16}};
  drive.node.tpdos = {tpdo1, tpdo2};
  drive.node.rpdos = {rpdo1};
}

}  // namespace

config::Drive drive() {
  config::Drive drive;
  drive.name = "pump1";
  drive.profile = "test";
  drive.unit = 5;
  drive.node.node = 5;
  drive.node.emcy.layout = canopen::EmcyLayout::drive_code;
  add_signals(drive);
  add_pdos(drive);
  drive.faults.fault = drive.find("fault");
  drive.faults.warning = drive.find("warning");
  drive.faults.running = drive.find("running");
  drive.faults.fault_code = drive.find("fault_code");
  drive.faults.drive_texts = {{0x04, {"Overcurrent during acceleration", config::Severity::fault}},
                              {0x05, {"Overcurrent during deceleration", config::Severity::fault}},
                              {0x40, {"Undervoltage while stopped", config::Severity::warning}}};
  drive.node.motor.control = test::kControl;
  drive.node.motor.stops = {{.equals = 5}};
  drive.commands.writers = {.modbus = true, .mqtt = true, .local = true};
  return drive;
}

}  // namespace process::test
