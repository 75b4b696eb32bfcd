#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bridges/modbus/drive_unit.h"
#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/lagging_link.h"
#include "tests/support/scripted_slave.h"
#include "tests/support/spawn.h"
#include "tests/unit/process/test_drive.h"

namespace modbus {
namespace {

using namespace std::chrono_literals;
using alarms::AlarmKind;
using canopen::Duration;

constexpr std::size_t kDrives = 8;
constexpr std::size_t kMissing = kDrives;  ///< One more, which is not there: its alarm stands all the time.

config::Drive drive_of_node(std::size_t index) {
  config::Drive drive = process::test::drive();
  const auto node = static_cast<std::uint8_t>(index + 1);
  drive.name = "pump" + std::to_string(node);
  drive.bus = index % 2;
  drive.unit = node;
  drive.node.node = node;
  drive.node.tpdos[0].cob_id = 0x180U + node;
  drive.node.tpdos[1].cob_id = 0x280U + node;
  drive.node.rpdos[0].cob_id = 0x200U + node;
  return drive;
}

config::Model model_of(std::size_t drives) {
  config::Model model;
  model.buses.resize(2);
  model.buses[0].name = "can0";
  model.buses[1].name = "can1";
  for (std::size_t i = 0; i < drives; ++i) {
    model.drives.push_back(drive_of_node(i));
  }
  return model;
}

/// A bus whose frames may reach us late, with its drives.
struct Line {
  explicit Line(support::HandDrivenLoop& loop) : wire(loop.executor()) {
    auto made = std::make_unique<support::LaggingLink>(loop.executor(), wire.connect());
    link = made.get();
    canopen::BusSettings quiet;
    quiet.heartbeat = {};
    bus = std::make_unique<canopen::Bus>(loop.executor(), std::move(made), quiet);
    bus->start();
  }
  canopen::VirtualBus wire;
  support::LaggingLink* link = nullptr;
  std::unique_ptr<canopen::Bus> bus;
};

/// What it saw last of each emergency alarm, as a bridge that is told of changes does.
class Watcher final : public process::Observer {
 public:
  void on_values(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_freshness(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_commanded(const process::Drive&, std::span<const process::SignalId>) override {}
  void on_status(const process::Drive&) override {}
  void on_bus(std::size_t) override {}
  void on_alarm(const process::Drive& drive, AlarmKind kind) override {
    if (kind == AlarmKind::emcy) {
      first[drive.index()] = drive.alarm(kind).active && drive.alarm(kind).first;
    }
  }
  std::array<bool, kDrives + 1> first{};
};

class FirstOutPlantTest : public testing::Test {
 protected:
  FirstOutPlantTest() {
    for (std::size_t i = 0; i < kDrives; ++i) {
      slaves_.push_back(std::make_unique<support::ScriptedSlave>(loop_.executor(), lines_[i % 2].wire,
                                                                 static_cast<std::uint8_t>(i + 1)));
      support::ScriptedSlave& slave = *slaves_.back();
      namespace test = process::test;
      for (const canopen::ObjectAddress object : {test::kControl, test::kFrequency, test::kTorque, test::kLimit,
                                                  test::kOutput, test::kTemperature, test::kFaultCode}) {
        slave.set(object, canopen::DataType::u16, 0);
      }
      slave.set({0x1000, 0}, canopen::DataType::u32, 0);
      slave.set({0x1017, 0}, canopen::DataType::u16, 500);
      tripped(i, false);
    }
    build();
    for (const auto& slave : slaves_) {
      slave->boot_up();
    }
    pass(6s);  // The missing drive is missed for longer than two seconds.
  }
  ~FirstOutPlantTest() override {
    end();
    for (Line& line : lines_) {
      const auto stopped = support::spawn(loop_.executor(), line.bus->stop());
      loop_.settle();
      EXPECT_TRUE(*stopped);
    }
  }

  void build() {
    plant_ = std::make_unique<process::Plant>(
        loop_.executor(), model_,
        std::vector<process::Plant::BusPort>{{lines_[0].bus.get(), {}}, {lines_[1].bus.get(), {}}});
    plant_->add(watcher_);
    units_.clear();
    for (std::size_t i = 0; i < kDrives; ++i) {
      units_.emplace_back(*plant_, plant_->drive(i), config::WordOrder::big);
    }
    plant_->start();
  }
  void end() {
    const auto stopped = support::spawn(loop_.executor(), plant_->stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
    units_.clear();
    plant_.reset();
  }

  /// Time passes with a TPDO of each drive in every 100 ms.
  void pass(Duration time) {
    for (Duration passed{}; passed < time; passed += 100ms) {
      for (std::size_t i = 0; i < kDrives; ++i) {
        send_status(i);
      }
      loop_.advance(100ms, 20ms);
    }
  }
  void send_status(std::size_t index) {
    if (slaves_[index]->state() == 5) {
      slaves_[index]->send(0x181U + static_cast<std::uint32_t>(index), {status_[index], 0, 0, 0, 0, 0});
      slaves_[index]->send(0x281U + static_cast<std::uint32_t>(index), {0, 0});
    }
  }
  void send_emcy(std::size_t index, std::uint8_t code) {
    const std::uint8_t reg = code != 0 ? 1 : 0;
    slaves_[index]->send(0x081U + static_cast<std::uint32_t>(index), {code, 0, reg, code, 0, 0, 0, 0});
  }
  void tripped(std::size_t index, bool is) {
    status_[index] = is ? static_cast<std::uint8_t>(process::test::kFaultBit) : 0;
    slaves_[index]->set(process::test::kStatusWord, canopen::DataType::u16, status_[index]);
    slaves_[index]->set({0x1001, 0}, canopen::DataType::u8, is ? 1 : 0);
  }

  /// All drives trip in this order within 5 ms, each telling so by an EMCY, by its TPDO, or by both. Where `lagging`,
  /// the frames of the buses reach us afterwards, one bus after the other.
  void trip(const std::vector<std::size_t>& order, bool lagging) {
    for (Line& line : lines_) {
      if (lagging) {
        line.link->stall();
      }
    }
    for (const std::size_t index : order) {
      tripped(index, true);
      const int way = random(0, 2);
      if (way != 0) {
        send_emcy(index, static_cast<std::uint8_t>(random(4, 5)));
      }
      if (way != 1) {
        send_status(index);
      }
      loop_.settle();
      loop_.advance(1us * random(1, 600), 1ms);
    }
    if (lagging) {
      const auto from = static_cast<std::size_t>(random(0, 1));
      for (const std::size_t line : {from, 1 - from}) {
        lines_[line].link->resume();
        loop_.settle();
      }
    }
  }
  void clear() {
    for (std::size_t i = 0; i < kDrives; ++i) {
      tripped(i, false);
      send_emcy(i, 0);
      send_status(i);
    }
    pass(3s);
  }
  int random(int from, int to) { return std::uniform_int_distribution<int>(from, to)(random_); }
  std::vector<std::size_t> any_order() {
    std::vector<std::size_t> order(kDrives);
    std::iota(order.begin(), order.end(), 0U);
    std::shuffle(order.begin(), order.end(), random_);
    return order;
  }

  [[nodiscard]] const alarms::Alarm& emcy(std::size_t index) const {
    return plant_->drive(index).alarm(AlarmKind::emcy);
  }
  [[nodiscard]] std::uint16_t register_1016(std::size_t index) const {
    std::array<std::uint16_t, 1> word{};
    EXPECT_FALSE(units_[index].read_registers({1016, 1}, canopen::Clock::now(), word));
    return word[0];
  }
  /// By alarm, by what an observer was told last, and by register.
  void expect_first(std::optional<std::size_t> first) {
    for (std::size_t i = 0; i < kDrives; ++i) {
      EXPECT_TRUE(emcy(i).active) << i;
      EXPECT_EQ(emcy(i).first, i == first) << i;
      EXPECT_EQ(watcher_.first.at(i), i == first) << i;
      EXPECT_EQ(register_1016(i), i == first ? 1 : 0) << i;
    }
  }

  support::HandDrivenLoop loop_;
  std::array<Line, 2> lines_{Line(loop_), Line(loop_)};
  std::vector<std::unique_ptr<support::ScriptedSlave>> slaves_;
  std::array<std::uint8_t, kDrives> status_{};
  config::Model model_ = model_of(kDrives + 1);
  Watcher watcher_;
  std::unique_ptr<process::Plant> plant_;
  std::vector<DriveUnit> units_;
  std::mt19937 random_{2};  // NOLINT(cert-msc32-c,cert-msc51-cpp,bugprone-random-generator-seed): the same every time.
};

TEST_F(FirstOutPlantTest, EightDrivesTripWithinFiveMilliseconds) {
  ASSERT_EQ(plant_->online(), kDrives);
  const alarms::Alarm standing = plant_->drive(kMissing).alarm(AlarmKind::heartbeat);
  ASSERT_TRUE(standing.active);
  EXPECT_TRUE(standing.first) << "nothing came before it";
  for (int round = 0; round < 100 && !HasFailure(); ++round) {
    const std::vector<std::size_t> order = any_order();
    trip(order, round % 4 != 0);
    expect_first(order.front());
    clear();
    ASSERT_FALSE(emcy(order.front()).active) << "round " << round;
    EXPECT_TRUE(emcy(order.front()).first) << "of what is over it is still told";
    EXPECT_EQ(register_1016(order.front()), 1) << "until the next group begins";
  }
  EXPECT_EQ(plant_->drive(kMissing).alarm(AlarmKind::heartbeat), standing);
}

TEST_F(FirstOutPlantTest, OverARestart) {
  const std::vector<std::size_t> order = any_order();
  trip(order, true);
  const std::optional<alarms::FaultSource> newest = plant_->first_out();
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->index, order.front());
  clear();
  end();
  model_ = model_of(kDrives);
  build();
  EXPECT_EQ(plant_->first_out(), std::nullopt);
  plant_->restore_first_out(*newest);
  pass(3s);
  ASSERT_EQ(plant_->online(), kDrives);
  for (std::size_t i = 0; i < kDrives; ++i) {
    EXPECT_EQ(register_1016(i), i == order.front() ? 1 : 0);
  }
  const std::vector<std::size_t> reversed(order.rbegin(), order.rend());
  trip(reversed, true);
  expect_first(order.back());
}

TEST_F(FirstOutPlantTest, WhereABusWasFirstNoDriveIs) {
  plant_->set_bus_state(1, {canopen::BusCondition::passive, 128, 0});
  EXPECT_FALSE(plant_->bus_alarm(1).first) << "a warning never is";
  pass(3s);
  plant_->set_bus_state(1, {canopen::BusCondition::bus_off, 255, 0});
  EXPECT_TRUE(plant_->bus_alarm(1).first);
  trip(any_order(), false);
  EXPECT_TRUE(plant_->bus_alarm(1).first);
  expect_first(std::nullopt);
}

TEST_F(FirstOutPlantTest, AWarningIsNeverFirstAndOneMoreFaultInsideCounts) {
  // Of this drive code 0x40 is a warning.
  send_emcy(0, 0x40);
  loop_.settle();
  ASSERT_TRUE(emcy(0).active);
  ASSERT_EQ(emcy(0).severity, config::Severity::warning);
  EXPECT_FALSE(emcy(0).first);
  EXPECT_EQ(register_1016(0), 0);
  const std::string id = emcy(0).id;
  loop_.advance(10ms);
  send_emcy(0, 4);
  loop_.settle();
  EXPECT_TRUE(emcy(0).first);
  EXPECT_EQ(emcy(0).id, id);
  EXPECT_EQ(register_1016(0), 1);
}

}  // namespace
}  // namespace modbus
