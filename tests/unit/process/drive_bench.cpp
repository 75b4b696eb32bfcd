#include "tests/unit/process/drive_bench.h"

namespace process {

DriveBench::DriveBench() {
  bus_.start();
  slave_.set({0x1000, 0}, canopen::DataType::u32, 0);
  slave_.set({0x1001, 0}, canopen::DataType::u8, 0);
  slave_.set({0x1017, 0}, canopen::DataType::u16, 500);
  for (const canopen::ObjectAddress object : {test::kControl, test::kFrequency, test::kTorque, test::kLimit,
                                              test::kOutput, test::kTemperature, test::kFaultCode}) {
    slave_.set(object, canopen::DataType::u16, 0);
  }
  slave_.set(test::kStatusWord, canopen::DataType::u16, 0);
}

DriveBench::~DriveBench() {
  if (drive_) {
    stop();
  }
  const auto stopped = support::spawn(loop_.executor(), bus_.stop());
  loop_.settle();
  EXPECT_TRUE(*stopped);
}

canopen::BusSettings DriveBench::quiet_bus() {
  canopen::BusSettings settings;
  settings.heartbeat = Duration::zero();
  return settings;
}

void DriveBench::start() {
  drive_ = std::make_unique<Drive>(loop_.executor(), model_, 0, bus_, observers_);
  drive_->start();
  loop_.settle();
}

void DriveBench::stop() {
  const std::size_t heard = slave_.heard().size();
  const auto stopped = support::spawn(loop_.executor(), drive_->stop());
  loop_.settle();
  EXPECT_TRUE(*stopped);
  EXPECT_EQ(slave_.heard().size(), heard) << "an end sends nothing";
  drive_.reset();
}

void DriveBench::run(Duration time) {
  for (Duration passed{}; passed < time; passed += std::chrono::milliseconds(1)) {
    loop_.advance(std::chrono::milliseconds(1));
    next_tpdo_ -= std::chrono::milliseconds(1);
    if (next_tpdo_ <= Duration::zero()) {
      send_tpdos();
    }
  }
}

void DriveBench::show(Raw status_word) {
  status_word_ = status_word;
  send_tpdos();
}

void DriveBench::send_tpdos() {
  next_tpdo_ = test::kPeriod;
  slave_.set(test::kStatusWord, canopen::DataType::u16, status_word_);
  if (fault_code_readable_) {
    slave_.set(test::kFaultCode, canopen::DataType::u16, fault_code_);
  }
  if (slave_.state() == 5 && !silent_) {
    slave_.send(0x185, {low(status_word_), high(status_word_), 0, 0, 0x85, 0x13});
    slave_.send(0x285, {low(fault_code_), high(fault_code_)});
  }
  loop_.settle();
}

void DriveBench::emcy(std::uint16_t code, std::uint8_t error_register) {
  slave_.send(0x085, {low(code), high(code), error_register, low(code), high(code), 0, 0, 0});
  loop_.settle();
}

void DriveBench::bring_online() {
  start();
  slave_.boot_up();
  run(std::chrono::milliseconds(2500));
  ASSERT_TRUE(drive_->status().online) << drive_->status().boot_text;
  slave_.forget_heard();
}

support::Spawned<Outcome> DriveBench::write(std::vector<FieldWrite> fields) {
  return support::spawn(loop_.executor(), drive_->write(origin(), std::move(fields)));
}

Outcome DriveBench::finish(const support::Spawned<Outcome>& under_way, Duration time) {
  if (!under_way.done()) {
    run(time);
  }
  EXPECT_TRUE(under_way.done());
  return under_way.done() ? under_way.get() : Outcome(canopen::Error{});
}

Outcome DriveBench::write_now(std::vector<FieldWrite> fields) {
  return finish(write(std::move(fields)));
}

Outcome DriveBench::nmt_now(canopen::NmtCommand command) {
  return finish(support::spawn(loop_.executor(), drive_->nmt(origin(), command)));
}

Outcome DriveBench::sdo_write_now(canopen::ObjectAddress object, Bytes data) {
  return finish(support::spawn(loop_.executor(), drive_->sdo_write(origin(), object, std::move(data))));
}

Outcome DriveBench::sdo_write_now(canopen::ObjectValue value) {
  return finish(support::spawn(loop_.executor(), drive_->sdo_write(origin(), value)));
}

Outcome DriveBench::write_all(Raw control, double frequency, double torque) {
  return write_now(
      {field("control_command", control), field("frequency_command", frequency), field("torque_command", torque)});
}

void DriveBench::run_motor() {
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  show(test::kRunningBit);
  slave_.forget_heard();
}

std::vector<DriveBench::Bytes> DriveBench::rpdos() const {
  std::vector<Bytes> data;
  for (const canopen::Frame& frame : slave_.heard_on(kRpdo1)) {
    data.emplace_back(frame.bytes().begin(), frame.bytes().end());
  }
  return data;
}

}  // namespace process
