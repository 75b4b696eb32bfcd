#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bridges/process/drive.h"
#include "canopen/bus.h"
#include "canopen/virtual_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/scripted_slave.h"
#include "tests/support/spawn.h"
#include "tests/unit/process/test_drive.h"

namespace process {

/// Remembers what a drive told.
class RecordedObserver final : public Observer {
 public:
  void on_values(const Drive&, std::span<const SignalId> signals) override { add(values, signals); }
  void on_freshness(const Drive&, std::span<const SignalId> signals) override { add(stale, signals); }
  void on_commanded(const Drive&, std::span<const SignalId> signals) override { add(commanded, signals); }
  void on_outcome_unknown(const Drive&, std::span<const SignalId> signals) override { add(unknown, signals); }
  void on_status(const Drive&) override { ++statuses; }
  void on_alarm(const Drive&, AlarmKind kind) override { alarms.push_back(kind); }
  void on_bus(std::size_t bus) override { buses.push_back(bus); }
  void on_remark(const Drive&, const std::string& text) override { remarks.push_back(text); }

  std::vector<std::vector<SignalId>> values;
  std::vector<std::vector<SignalId>> stale;
  std::vector<std::vector<SignalId>> commanded;
  std::vector<std::vector<SignalId>> unknown;
  int statuses = 0;
  std::vector<AlarmKind> alarms;
  std::vector<std::size_t> buses;
  std::vector<std::string> remarks;

 private:
  static void add(std::vector<std::vector<SignalId>>& list, std::span<const SignalId> signals) {
    list.emplace_back(signals.begin(), signals.end());
  }
};

/// A drive with its remote node on an in-process bus, and a scripted slave that sends its TPDOs every 100 ms.
class DriveBench : public testing::Test {
 protected:
  using Raw = canopen::Raw;
  using Duration = canopen::Duration;
  using Bytes = std::vector<std::uint8_t>;
  static constexpr std::uint32_t kRpdo1 = 0x205;

  DriveBench() {
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
  ~DriveBench() override {
    if (drive_) {
      stop();
    }
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }

  static canopen::BusSettings quiet_bus() {
    canopen::BusSettings settings;
    settings.heartbeat = Duration::zero();
    return settings;
  }

  void start() {
    drive_ = std::make_unique<Drive>(loop_.executor(), model_, 0, bus_, observers_);
    drive_->start();
    loop_.settle();
  }
  void stop() {
    const std::size_t heard = slave_.heard().size();
    const auto stopped = support::spawn(loop_.executor(), drive_->stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
    EXPECT_EQ(slave_.heard().size(), heard) << "an end sends nothing";
    drive_.reset();
  }

  /// Time passes; an operational slave sends its TPDOs.
  void run(Duration time) {
    for (Duration passed{}; passed < time; passed += std::chrono::milliseconds(1)) {
      loop_.advance(std::chrono::milliseconds(1));
      next_tpdo_ -= std::chrono::milliseconds(1);
      if (next_tpdo_ <= Duration::zero()) {
        send_tpdos();
      }
    }
  }
  /// The state of the motor as the next TPDO tells it, which comes at once.
  void show(Raw status_word) {
    status_word_ = status_word;
    send_tpdos();
  }
  void send_tpdos() {
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
  void emcy(std::uint16_t code, std::uint8_t error_register) {
    slave_.send(0x085, {low(code), high(code), error_register, low(code), high(code), 0, 0, 0});
    loop_.settle();
  }

  /// The slave boots and the drive is online with fresh values.
  void bring_online() {
    start();
    slave_.boot_up();
    run(std::chrono::milliseconds(2500));
    ASSERT_TRUE(drive_->status().online) << drive_->status().boot_text;
    slave_.forget_heard();
  }

  [[nodiscard]] SignalId signal(std::string_view name) const { return test::id(model_, name); }
  [[nodiscard]] FieldWrite field(std::string_view name, std::variant<Raw, double> value) const {
    return {signal(name), value};
  }
  static Writer writer(Writer::Way way = Writer::Way::modbus) {
    return {way, way == Writer::Way::modbus ? "192.0.2.7" : ""};
  }

  support::Spawned<Outcome> write(std::vector<FieldWrite> fields) {
    return support::spawn(loop_.executor(), drive_->write(writer(), std::move(fields)));
  }
  /// The outcome, where it comes within some milliseconds.
  Outcome finish(const support::Spawned<Outcome>& under_way, Duration time = std::chrono::milliseconds(20)) {
    if (!under_way.done()) {
      run(time);
    }
    EXPECT_TRUE(under_way.done());
    return under_way.done() ? under_way.get() : Outcome(canopen::Error{});
  }
  Outcome write_now(std::vector<FieldWrite> fields) { return finish(write(std::move(fields))); }
  Outcome nmt_now(canopen::NmtCommand command) {
    return finish(support::spawn(loop_.executor(), drive_->nmt(writer(), command)));
  }
  Outcome sdo_write_now(canopen::ObjectValue value) {
    return finish(support::spawn(loop_.executor(), drive_->sdo_write(writer(), value)));
  }
  /// All fields of RPDO1 in one command.
  Outcome write_all(Raw control, double frequency, double torque = 0.0) {
    return write_now(
        {field("control_command", control), field("frequency_command", frequency), field("torque_command", torque)});
  }
  /// All fields were commanded and the motor turns.
  void run_motor() {
    ASSERT_TRUE(write_all(1, 30.0).has_value());
    show(test::kRunningBit);
    slave_.forget_heard();
  }

  /// The data of the RPDOs heard since the last forget_heard().
  [[nodiscard]] std::vector<Bytes> rpdos() const {
    std::vector<Bytes> data;
    for (const canopen::Frame& frame : slave_.heard_on(kRpdo1)) {
      data.emplace_back(frame.bytes().begin(), frame.bytes().end());
    }
    return data;
  }
  [[nodiscard]] std::vector<canopen::ObjectAddress> sdo_writes() const { return slave_.writes(); }
  [[nodiscard]] const Alarm& alarm(AlarmKind kind) const { return drive_->alarm(kind); }
  [[nodiscard]] bool fresh(std::string_view name) const {
    return drive_->image().fresh(signal(name), canopen::Clock::now());
  }

  static std::uint8_t low(Raw value) { return static_cast<std::uint8_t>(value & 0xFFU); }
  static std::uint8_t high(Raw value) { return static_cast<std::uint8_t>((value >> 8U) & 0xFFU); }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  canopen::Bus bus_{loop_.executor(), wire_.connect(), quiet_bus()};
  support::ScriptedSlave slave_{loop_.executor(), wire_, 5};
  config::Drive model_ = test::drive();
  RecordedObserver observer_;
  std::vector<Observer*> observers_{&observer_};
  std::unique_ptr<Drive> drive_;
  Raw status_word_ = 0;
  Raw fault_code_ = 0;
  bool fault_code_readable_ = true;
  bool silent_ = false;
  Duration next_tpdo_ = test::kPeriod;
};

using Objects = std::vector<canopen::ObjectAddress>;

}  // namespace process
