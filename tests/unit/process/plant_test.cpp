#include "bridges/process/plant.h"

#include <gtest/gtest.h>

#include "tests/unit/process/drive_bench.h"

namespace process {
namespace {

using canopen::BusCondition;
using namespace std::chrono_literals;

/// Of which buses the alarm was told.
class BusAlarms final : public Observer {
 public:
  void on_values(const Drive&, std::span<const SignalId>) override {}
  void on_freshness(const Drive&, std::span<const SignalId>) override {}
  void on_commanded(const Drive&, std::span<const SignalId>) override {}
  void on_status(const Drive&) override {}
  void on_alarm(const Drive&, alarms::AlarmKind) override {}
  void on_bus(std::size_t) override {}
  void on_bus_alarm(std::size_t bus) override { told.push_back(bus); }
  std::vector<std::size_t> told;
};

class PlantTest : public testing::Test {
 protected:
  PlantTest() {
    config::Bus bus;
    bus.name = "can0";
    model_.buses = {bus};
    model_.drives = {test::drive(), test::drive()};
    model_.drives[1].name = "pump2";
    model_.drives[1].node.node = 6;
    model_.drives[1].node.tpdos.clear();
    bus_.start();
    plant_ = std::make_unique<Plant>(loop_.executor(), model_,
                                     std::vector<Plant::BusPort>{{&bus_, [] {
                                                                    canopen::BusStatistics statistics;
                                                                    statistics.frames_sent = 42;
                                                                    return statistics;
                                                                  }}});
    plant_->add(observer_);
    plant_->add(bus_alarms_);
  }
  ~PlantTest() override {
    const auto stopped = support::spawn(loop_.executor(), plant_->stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
    plant_.reset();
    const auto bus_stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*bus_stopped);
  }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  canopen::Bus bus_{loop_.executor(), wire_.connect(), {}};
  support::ScriptedSlave slave_{loop_.executor(), wire_, 5};
  config::Model model_;
  RecordedObserver observer_;
  BusAlarms bus_alarms_;
  std::unique_ptr<Plant> plant_;
};

TEST_F(PlantTest, CountsDrivesOnlineAndWithAlarm) {
  slave_.set({0x1000, 0}, canopen::DataType::u32, 0);
  slave_.set({0x1001, 0}, canopen::DataType::u8, 0);
  slave_.set({0x1017, 0}, canopen::DataType::u16, 500);
  ASSERT_EQ(plant_->size(), 2U);
  EXPECT_EQ(plant_->drive(1).index(), 1U);
  EXPECT_EQ(plant_->drive(1).model().name, "pump2");
  plant_->start();
  slave_.boot_up();
  loop_.advance(2500ms);
  EXPECT_EQ(plant_->online(), 1U);
  EXPECT_TRUE(plant_->drive(1).alarm(alarms::AlarmKind::heartbeat).active);
  EXPECT_GE(plant_->with_alarm(), 1U);
  EXPECT_GT(observer_.statuses, 0);
}

TEST_F(PlantTest, BusStateAndAlarm) {
  EXPECT_FALSE(plant_->bus_alarm(0).active);
  plant_->set_bus_state(0, {BusCondition::error_active, 0, 0});
  EXPECT_FALSE(plant_->bus_alarm(0).active);
  plant_->set_bus_state(0, {BusCondition::passive, 128, 0});
  EXPECT_TRUE(plant_->bus_alarm(0).active);
  EXPECT_EQ(plant_->bus_alarm(0).severity, config::Severity::warning);
  EXPECT_EQ(plant_->bus_state(0).transmit_errors, 128);
  const std::string id = plant_->bus_alarm(0).id;
  plant_->set_bus_state(0, {BusCondition::bus_off, 255, 0});
  EXPECT_EQ(plant_->bus_alarm(0).severity, config::Severity::fault);
  EXPECT_EQ(plant_->bus_alarm(0).id, id);
  EXPECT_TRUE(plant_->bus_alarm(0).text.starts_with("bus-off: the controller has left the bus. What to do first: "))
      << plant_->bus_alarm(0).text;
  plant_->set_bus_state(0, {BusCondition::error_active, 0, 0});
  EXPECT_FALSE(plant_->bus_alarm(0).active);
  plant_->set_bus_state(0, {BusCondition::down, 0, 0});
  EXPECT_NE(plant_->bus_alarm(0).id, id);
  EXPECT_EQ(plant_->bus_alarm(0).count, 2U);
  EXPECT_EQ(observer_.buses.size(), 5U);
  EXPECT_EQ(plant_->bus_statistics(0).frames_sent, 42U);
}

TEST_F(PlantTest, ErrorCountersAloneAreNoChangeOfABusAlarm) {
  plant_->set_bus_state(0, {BusCondition::passive, 128, 0});
  ASSERT_EQ(bus_alarms_.told, (std::vector<std::size_t>{0}));
  const alarms::Alarm told = plant_->bus_alarm(0);
  EXPECT_EQ(told.reason, "passive");
  for (std::uint16_t errors = 129; errors < 149; ++errors) {
    loop_.advance(1ms);
    plant_->set_bus_state(0, {BusCondition::passive, errors, 0});
  }
  EXPECT_EQ(bus_alarms_.told.size(), 1U);
  EXPECT_EQ(plant_->bus_alarm(0), told);
  EXPECT_EQ(observer_.buses.size(), 21U);
  plant_->set_bus_state(0, {BusCondition::bus_off, 255, 0});
  EXPECT_EQ(bus_alarms_.told.size(), 2U) << "once, with its flag";
  EXPECT_TRUE(plant_->bus_alarm(0).first);
}

TEST_F(PlantTest, ListsWhatIsActiveOldestFirst) {
  EXPECT_TRUE(plant_->active_alarms().empty());
  slave_.set({0x1000, 0}, canopen::DataType::u32, 0);
  slave_.set({0x1001, 0}, canopen::DataType::u8, 0);
  slave_.set({0x1017, 0}, canopen::DataType::u16, 500);
  plant_->start();
  slave_.boot_up();
  loop_.advance(2500ms);
  ASSERT_TRUE(plant_->drive(0).status().online);
  plant_->set_bus_state(0, {BusCondition::passive, 128, 0});
  loop_.advance(1ms);
  slave_.send(0x085, {0x10, 0x23, 0x01, 0, 0, 0, 0, 0});
  loop_.advance(1ms);
  std::vector<ActiveAlarm> active = plant_->active_alarms();
  std::erase_if(active, [](const ActiveAlarm& one) { return one.kind == alarms::AlarmKind::data; });
  ASSERT_EQ(active.size(), 3U);
  EXPECT_EQ(active[0].drive, &plant_->drive(1));
  EXPECT_EQ(active[0].kind, alarms::AlarmKind::heartbeat);
  EXPECT_EQ(active[0].alarm, &plant_->drive(1).alarm(alarms::AlarmKind::heartbeat));
  EXPECT_EQ(active[1].drive, nullptr);
  EXPECT_EQ(active[1].bus, 0U);
  EXPECT_EQ(active[1].alarm, &plant_->bus_alarm(0));
  EXPECT_EQ(active[2].drive, &plant_->drive(0)) << "the youngest, though of the first drive";
  EXPECT_EQ(active[2].kind, alarms::AlarmKind::emcy);
  EXPECT_EQ(active[2].alarm->code, 0x2310);
}

TEST_F(PlantTest, AnotherGatewayOfOurNameIsAWarningOfEachBusThatHasNothingWorse) {
  plant_->set_other_gateway(true);
  EXPECT_FALSE(plant_->bus_alarm(0).known) << "the bus has not told its state";
  plant_->set_bus_state(0, {BusCondition::error_active, 0, 0});
  EXPECT_TRUE(plant_->bus_alarm(0).active);
  EXPECT_EQ(plant_->bus_alarm(0).reason, "other-gateway");
  EXPECT_EQ(plant_->bus_alarm(0).severity, config::Severity::warning);
  const std::string id = plant_->bus_alarm(0).id;
  plant_->set_bus_state(0, {BusCondition::bus_off, 0, 0});
  EXPECT_EQ(plant_->bus_alarm(0).reason, "bus-off");
  EXPECT_EQ(plant_->bus_alarm(0).severity, config::Severity::fault);
  plant_->set_bus_state(0, {BusCondition::error_active, 0, 0});
  EXPECT_EQ(plant_->bus_alarm(0).reason, "other-gateway");
  EXPECT_EQ(plant_->bus_alarm(0).id, id) << "it was active all the time";
  bus_alarms_.told.clear();
  plant_->set_other_gateway(false);
  EXPECT_FALSE(plant_->bus_alarm(0).active);
  EXPECT_EQ(bus_alarms_.told, std::vector<std::size_t>{0});
}

}  // namespace
}  // namespace process
