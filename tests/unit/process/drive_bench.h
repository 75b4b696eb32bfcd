#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bridges/process/drive.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/lagging_link.h"
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
  void on_command_done(const Drive&, const CommandRecord& record, const Outcome& outcome) override {
    answers.emplace_back(record, outcome);
  }
  void on_status(const Drive&) override { ++statuses; }
  void on_alarm(const Drive&, alarms::AlarmKind kind) override { alarms.push_back(kind); }
  void on_bus(std::size_t bus) override { buses.push_back(bus); }
  void on_remark(const Drive&, const std::string& text) override { remarks.push_back(text); }

  std::vector<std::vector<SignalId>> values;
  std::vector<std::vector<SignalId>> stale;
  std::vector<std::vector<SignalId>> commanded;
  std::vector<std::pair<CommandRecord, Outcome>> answers;
  int statuses = 0;
  std::vector<alarms::AlarmKind> alarms;
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

  DriveBench();
  ~DriveBench() override;

  static canopen::BusSettings quiet_bus();

  void start();
  void stop();
  /// Time passes; an operational slave sends its TPDOs.
  void run(Duration time);
  /// The state of the motor as the next TPDO tells it, which comes at once.
  void show(Raw status_word);
  void send_tpdos();
  void emcy(std::uint16_t code, std::uint8_t error_register);
  /// The slave boots and the drive is online with fresh values.
  void bring_online();

  [[nodiscard]] SignalId signal(std::string_view name) const { return test::id(model_, name); }
  [[nodiscard]] FieldWrite field(std::string_view name, GivenValue value) const { return {signal(name), value}; }
  static Origin origin(Writer::Way way = Writer::Way::modbus) {
    return {.writer = {.way = way, .address = way == Writer::Way::modbus ? "192.0.2.7" : ""}};
  }

  support::Spawned<Outcome> write(std::vector<FieldWrite> fields);
  /// The outcome, where it comes within some milliseconds.
  Outcome finish(const support::Spawned<Outcome>& under_way, Duration time = std::chrono::milliseconds(20));
  Outcome write_now(std::vector<FieldWrite> fields);
  Outcome nmt_now(canopen::NmtCommand command);
  Outcome sdo_write_now(canopen::ObjectValue value);
  Outcome sdo_write_now(canopen::ObjectAddress object, Bytes data);
  /// All fields of RPDO1 in one command.
  Outcome write_all(Raw control, double frequency, double torque = 0.0);
  /// All fields were commanded and the motor turns.
  void run_motor();

  /// The data of the RPDOs heard since the last forget_heard().
  [[nodiscard]] std::vector<Bytes> rpdos() const;
  [[nodiscard]] std::vector<canopen::ObjectAddress> sdo_writes() const { return slave_.writes(); }
  [[nodiscard]] const alarms::Alarm& alarm(alarms::AlarmKind kind) const { return drive_->alarm(kind); }
  [[nodiscard]] bool fresh(std::string_view name) const {
    return drive_->image().fresh(signal(name), canopen::Clock::now());
  }

  static std::uint8_t low(Raw value) { return static_cast<std::uint8_t>(value & 0xFFU); }
  static std::uint8_t high(Raw value) { return static_cast<std::uint8_t>((value >> 8U) & 0xFFU); }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  std::unique_ptr<support::LaggingLink> made_ =
      std::make_unique<support::LaggingLink>(loop_.executor(), wire_.connect());
  support::LaggingLink& link_ = *made_;
  canopen::Bus bus_{loop_.executor(), std::move(made_), quiet_bus()};
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
