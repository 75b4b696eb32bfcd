#include "daemon/alarm_log.h"

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "bridges/process/observer.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/change_plant.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/scripted_slave.h"
#include "tests/support/spawn.h"
#include "tests/unit/process/test_drive.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;
using canopen::BusCondition;
using Lines = std::vector<std::string>;

/// A drive that says nothing but emergencies, and what is logged of it.
class AlarmLogTest : public testing::Test, private process::Observer {
 protected:
  AlarmLogTest() {
    model_.buses.resize(1);
    model_.buses[0].name = "can0";
    model_.drives = {process::test::drive()};
    bus_.start();
    plant_ =
        std::make_unique<process::Plant>(loop_.executor(), model_, std::vector<process::Plant::BusPort>{{&bus_, {}}});
    plant_->add(*this);
    log_ = std::make_unique<AlarmLog>(loop_.executor(), *plant_,
                                      [this](spdlog::level::level_enum level, const std::string& line) {
                                        lines_.push_back(line);
                                        levels_.push_back(level);
                                      });
    plant_->start();
    loop_.settle();
  }
  ~AlarmLogTest() override {
    const auto stopped = support::spawn(loop_.executor(), plant_->stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
    log_.reset();
    plant_.reset();
    const auto bus_stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*bus_stopped);
  }

  void emcy(std::uint8_t code) {
    slave_.send(0x085, {code, 0, static_cast<std::uint8_t>(code != 0 ? 1 : 0), code, 0, 0, 0, 0});
    loop_.settle();
  }
  /// The drive has another section.
  void change_drive() {
    config::Model now = model_;
    now.drives[0].commands.lease = 5s;
    support::change_plant(loop_, *plant_, now, {{&bus_, {}}});
    EXPECT_TRUE(plant_->drive(0).alarm(alarms::AlarmKind::emcy).active);
  }
  void bus(BusCondition condition, std::uint16_t errors = 0) {
    plant_->set_bus_state(0, {condition, errors, 0});
    loop_.settle();
  }
  /// Since the last call.
  Lines lines() { return std::exchange(lines_, {}); }
  /// The one line since the last call, where it says what to do: up to there.
  std::string told_and_what_to_do() {
    const Lines told = lines();
    const std::size_t end = told.size() == 1 ? told[0].find(". What to do first: ") : std::string::npos;
    EXPECT_NE(end, std::string::npos) << (told.empty() ? "nothing" : told[0]);
    return end == std::string::npos ? std::string() : told[0].substr(0, end);
  }

  support::HandDrivenLoop loop_;
  std::unique_ptr<AlarmLog> log_;
  std::vector<spdlog::level::level_enum> levels_;

 private:
  void on_values(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_freshness(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_commanded(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_status(const process::Drive&) override {}
  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind) override { log_->on_alarm(drive, kind); }
  void on_bus(std::size_t bus) override { log_->on_bus(bus); }
  void on_bus_alarm(std::size_t bus) override { log_->on_bus(bus); }
  void on_plant_change(const process::PlantChange& change) override { log_->on_plant_change(change); }

  canopen::VirtualBus wire_{loop_.executor()};
  canopen::Bus bus_{loop_.executor(), wire_.connect(), quiet()};
  support::ScriptedSlave slave_{loop_.executor(), wire_, 5};
  config::Model model_;
  std::unique_ptr<process::Plant> plant_;
  Lines lines_;

  static canopen::BusSettings quiet() {
    canopen::BusSettings settings;
    settings.heartbeat = {};
    return settings;
  }
};

TEST_F(AlarmLogTest, AFaultThatCameFirstIsNamedSo) {
  emcy(4);
  EXPECT_EQ(lines(), (Lines{"pump1: alarm emcy active, not confirmed, first: 0x0004 Overcurrent during acceleration"}));
  EXPECT_EQ(levels_, (std::vector{spdlog::level::err}));
  loop_.advance(1s);
  EXPECT_EQ(lines(), Lines{}) << "told already";
}

TEST_F(AlarmLogTest, AWarningIsNoError) {
  emcy(0x40);
  EXPECT_EQ(lines(), (Lines{"pump1: alarm emcy active, not confirmed: 0x0040 Undervoltage while stopped"}));
  EXPECT_EQ(levels_, (std::vector{spdlog::level::warn}));
}

TEST_F(AlarmLogTest, AStormIsTwoLinesASecondWithTheLastStateAtTheEnd) {
  for (int i = 0; i < 1000; ++i) {
    emcy(4);
    emcy(0);
    loop_.advance(1ms);
  }
  const Lines during = lines();
  ASSERT_EQ(during.size(), 3U) << "at once, after half a second, after a second";
  EXPECT_EQ(during[0], "pump1: alarm emcy active, not confirmed, first: 0x0004 Overcurrent during acceleration");
  EXPECT_EQ(during[1], "pump1: alarm emcy over: 0x0004 Overcurrent during acceleration (499 more in between)");
  EXPECT_EQ(during[2], "pump1: alarm emcy over: 0x0004 Overcurrent during acceleration (500 more in between)");
  emcy(5);
  EXPECT_EQ(lines(), Lines{});
  loop_.advance(500ms);
  EXPECT_EQ(lines(), (Lines{"pump1: alarm emcy active, not confirmed, first: 0x0005 Overcurrent during deceleration"}));
  loop_.advance(5s);
  for (const std::string& line : lines()) {
    EXPECT_EQ(line.find("alarm emcy"), std::string::npos) << line;
  }
}

TEST_F(AlarmLogTest, AtTheEndWhatIsHeldBackIsWritten) {
  emcy(4);
  emcy(0);
  EXPECT_EQ(lines().size(), 1U);
  log_->finish();
  EXPECT_EQ(lines(), (Lines{"pump1: alarm emcy over: 0x0004 Overcurrent during acceleration"}));
  log_->finish();
  EXPECT_EQ(lines(), Lines{});
}

TEST_F(AlarmLogTest, ActivationsBetweenTwoLinesAreCounted) {
  emcy(4);
  for (int i = 0; i < 3; ++i) {
    emcy(0);
    emcy(4);
  }
  ASSERT_EQ(lines().size(), 1U);
  loop_.advance(500ms);
  EXPECT_EQ(lines(), (Lines{"pump1: alarm emcy active, not confirmed, first: 0x0004 Overcurrent during acceleration "
                            "(2 more in between)"}));
}

TEST_F(AlarmLogTest, KindsWithoutACodeHaveAReason) {
  bus(BusCondition::error_active);
  (void)lines();
  loop_.advance(5s);
  const Lines told = lines();
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(
      told[0],
      "pump1: alarm boot active, first: no-heartbeat: K: configured, but its heartbeat does not start: no heartbeat "
      "within 1500 ms, although 0x1017:00 should be 500 ms. What to do first: compare 0x1017 in the drive: where it "
      "keeps a longer time, raise heartbeat_timeout; where it has no heartbeat, use guarding");
}

TEST_F(AlarmLogTest, ABusHasALineForItsStateAndNoneForItsCounters) {
  bus(BusCondition::error_active);
  EXPECT_EQ(lines(), (Lines{"bus can0: up (error-active)"}));
  loop_.advance(500ms);
  bus(BusCondition::passive, 128);
  EXPECT_EQ(told_and_what_to_do(), "bus can0: error-passive: no other node acknowledges, or the wiring disturbs");
  for (std::uint16_t i = 0; i < 20; ++i) {
    bus(BusCondition::passive, static_cast<std::uint16_t>(129 + i));
    loop_.advance(10ms);
  }
  EXPECT_EQ(lines(), Lines{});
  loop_.advance(300ms);
  bus(BusCondition::bus_off, 255);
  EXPECT_EQ(told_and_what_to_do(), "bus can0: first: bus-off: the controller has left the bus");
  EXPECT_EQ(levels_, (std::vector{spdlog::level::info, spdlog::level::warn, spdlog::level::err}));
  for (int i = 0; i < 4; ++i) {
    bus(BusCondition::error_active);
    bus(BusCondition::bus_off);
  }
  bus(BusCondition::error_active);
  EXPECT_EQ(lines(), Lines{});
  loop_.advance(500ms);
  EXPECT_EQ(lines(), (Lines{"bus can0: up (error-active) (4 more in between)"}));
}

TEST_F(AlarmLogTest, WhatAChangedDriveHasOfBeforeIsNoNews) {
  emcy(0x05);
  ASSERT_EQ(lines().size(), 1U);
  change_drive();
  loop_.advance(2s);
  EXPECT_EQ(lines(), Lines{});
}

}  // namespace
}  // namespace gateway
