#include "bridges/process/plant_change.h"

#include "tests/unit/process/simulated_bus.h"

namespace process {
namespace {

using namespace std::chrono_literals;
using canopen::Duration;
constexpr std::optional<std::size_t> kNew = std::nullopt;

/// What it is told of a change, and whether anything is wrong with the positions that it is told later.
class Follower final : public Observer {
 public:
  explicit Follower(Plant& plant) : plant_(plant) {}
  void on_values(const Drive& drive, std::span<const SignalId>) override { look(drive); }
  void on_freshness(const Drive& drive, std::span<const SignalId>) override { look(drive); }
  void on_commanded(const Drive& drive, std::span<const SignalId>) override { look(drive); }
  void on_status(const Drive& drive) override { look(drive); }
  void on_alarm(const Drive& drive, alarms::AlarmKind) override { look(drive); }
  void on_bus(std::size_t bus) override { EXPECT_LT(bus, plant_.model().buses.size()); }
  void on_plant_change(const PlantChange& change) override {
    changes.push_back(change.drives);
    size_ = change.drives.size();
    for (std::size_t i = 0; i < size_; ++i) {
      EXPECT_EQ(plant_.drive(i).index(), i);
      EXPECT_EQ(plant_.drive(i).model().name, plant_.model().drives[i].name);
      EXPECT_TRUE(change.drives[i] || !plant_.drive(i).status().online) << "the new ones have not begun";
    }
  }
  std::vector<PlantChange::From> changes;

 private:
  void look(const Drive& drive) const {
    ASSERT_LT(drive.index(), plant_.size());
    EXPECT_EQ(&plant_.drive(drive.index()), &drive);
  }
  Plant& plant_;
  std::size_t size_ = 0;
};

std::string table(const std::string& name, int node, const std::string& more = "") {
  return "[[drive]]\nname = \"" + name +
         "\"\nbus = \"can0\"\nprofile = \"veichi-ac300\"\npresets = [\"veichi-command-codes\"]\nnode = " +
         std::to_string(node) + "\n[drive.commands]\nwriters = [\"modbus\"]\n" + more;
}

class PlantChangeTest : public SimulatedBus {
 protected:
  PlantChangeTest() {
    for (const int node : {3, 4, 5}) {
      add("veichi-ac300", static_cast<std::uint8_t>(node)).power_on();
    }
  }
  ~PlantChangeTest() override {
    if (follower_) {
      plant_->remove(*follower_);
    }
  }
  void begin(const std::string& drives) {
    load(drives);
    start();
    follower_ = std::make_unique<Follower>(*plant_);
    plant_->add(*follower_);
    ASSERT_TRUE(wait_online());
    run(2s);
    neighbour_.forget();
  }
  /// The same bus, these drives.
  void change(const std::string& drives, PlantChange::From from) {
    config::Model before = std::move(model_);  // The drives look at its parts, wherever it is.
    load(drives);
    auto next = std::make_shared<const config::Model>(std::move(model_));
    model_ = std::move(before);
    std::vector<std::size_t> leaving;
    for (std::size_t i = 0; i < plant_->size(); ++i) {
      if (std::ranges::find(from, std::optional(i)) == from.end()) {
        leaving.push_back(i);
      }
    }
    const auto stopped = support::spawn(loop_.executor(), plant_->stop(leaving));
    ASSERT_TRUE(loop_.advance_until([&] { return *stopped; }, 1s));
    plant_->change(std::move(next), {{bus_.get(), {}}}, {.drives = std::move(from), .buses = {0}});
    loop_.settle();
  }
  [[nodiscard]] std::size_t sdo_requests(std::uint8_t node) const { return neighbour_.heard(0x600U + node); }

  std::unique_ptr<Follower> follower_;
};

TEST_F(PlantChangeTest, WhatIsTheSameDoesNotNotice) {
  begin(table("pump1", 3) + table("pump2", 4));
  const Drive* const first = &plant_->drive(0);
  const Drive* const second = &plant_->drive(1);
  change(table("pump2", 4) + table("pump1", 3), {1, 0});
  EXPECT_EQ(&plant_->drive(0), second);
  EXPECT_EQ(&plant_->drive(1), first);
  EXPECT_EQ(plant_->find("pump1"), first);
  EXPECT_EQ(follower_->changes, (std::vector<PlantChange::From>{{1, 0}}));
  run(5s);
  EXPECT_EQ(plant_->online(), 2U);
  EXPECT_EQ(neighbour_.heard(0), 0U) << "no NMT command";
  EXPECT_EQ(plant_->drive(0).status().heartbeat_losses, 0U);
}

TEST_F(PlantChangeTest, AnotherDriveComesOnlineAndTheOthersAreNotTouched) {
  begin(table("pump1", 3));
  const std::size_t before = sdo_requests(3);
  change(table("pump2", 4) + table("pump1", 3), {kNew, 0});
  EXPECT_TRUE(wait_online());
  EXPECT_EQ(plant_->find("pump2")->index(), 0U);
  run(2s);
  EXPECT_TRUE(plant_->drive(0).image().all_fresh(canopen::Clock::now()));
  EXPECT_LE(sdo_requests(3), before + 40) << "its polls alone";
  EXPECT_EQ(neighbour_.downloads(3), 0U);
}

TEST_F(PlantChangeTest, OneThatLeftIsSentNothingMore) {
  begin(table("pump1", 3) + table("pump2", 4));
  change(table("pump2", 4), {1});
  neighbour_.forget();
  run(10s);
  EXPECT_EQ(plant_->size(), 1U);
  EXPECT_EQ(plant_->find("pump1"), nullptr);
  EXPECT_EQ(sdo_requests(3), 0U);
  EXPECT_EQ(neighbour_.heard(0), 0U);
  EXPECT_EQ(plant_->online(), 1U);
}

TEST_F(PlantChangeTest, WhoHoldsOneThatLeftIsAnswered) {
  begin(table("pump1", 3) + table("pump2", 4));
  Drive& old = plant_->drive(0);
  change(table("pump2", 4), {1});
  const auto answer = support::spawn(loop_.executor(),
                                     old.stop_motor({.writer = {.way = Writer::Way::modbus, .address = "192.0.2.7"}}));
  ASSERT_TRUE(loop_.advance_until([&] { return answer.done(); }, 1s));
  ASSERT_TRUE(answer.get().has_error());
  EXPECT_EQ(answer.get().error().kind, canopen::ErrorKind::offline);
  plant_->forget_left();
}

TEST_F(PlantChangeTest, AChangedOneHasTheAlarmsOfBefore) {
  begin(table("pump1", 3) + table("pump2", 4));
  drives_[0]->power_off();
  run(5s);
  const alarms::Alarm before = plant_->drive(0).alarm(alarms::AlarmKind::heartbeat);
  ASSERT_TRUE(before.active);
  change(table("pump2", 4) + table("pump1", 3, "lease = \"5s\"\n"), {1, kNew});
  const alarms::Alarm& now = plant_->find("pump1")->alarm(alarms::AlarmKind::heartbeat);
  EXPECT_EQ(now.id, before.id);
  EXPECT_TRUE(now.active);
  EXPECT_EQ(now.first, before.first);
  const std::vector<ActiveAlarm> active = plant_->active_alarms();
  EXPECT_TRUE(std::ranges::any_of(active, [&](const ActiveAlarm& one) { return one.alarm->id == before.id; }));
  drives_[0]->power_on();
  EXPECT_TRUE(wait_online());
  run(2s);
  EXPECT_FALSE(now.active);
}

TEST_F(PlantChangeTest, TheAlarmsOfARemovedOneAreGone) {
  begin(table("pump1", 3) + table("pump2", 4));
  drives_[0]->power_off();
  run(5s);
  ASSERT_TRUE(plant_->first_out().has_value());
  change(table("pump2", 4), {1});
  EXPECT_TRUE(plant_->active_alarms().empty());
  EXPECT_EQ(plant_->with_alarm(), 0U);
  EXPECT_EQ(plant_->first_out(), std::nullopt);
  run(5s);
  EXPECT_TRUE(plant_->active_alarms().empty());
}

TEST_F(PlantChangeTest, ACommandUnderWayIsAnsweredOffline) {
  begin(table("pump1", 3, "deadline = \"5s\"\n") + table("pump2", 4));
  drives_[0]->misbehaviour().sdo_delay = 4s;
  Drive& drive = plant_->drive(0);
  std::vector<FieldWrite> fields{{static_cast<SignalId>(drive.model().find("frequency_command").value()), 10.0}};
  const auto given =
      support::spawn(loop_.executor(),
                     drive.write({.writer = {.way = Writer::Way::modbus, .address = "192.0.2.7"}}, std::move(fields)));
  run(100ms);
  ASSERT_FALSE(given.done());
  change(table("pump2", 4), {1});
  ASSERT_TRUE(given.done()) << "before the drive is gone";
  ASSERT_TRUE(given.get().has_error());
  EXPECT_EQ(given.get().error().kind, canopen::ErrorKind::offline) << given.get().error().detail;
}

}  // namespace
}  // namespace process
