#include "bridges/recorder/recorder.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/change_plant.h"
#include "tests/unit/recorder/recorder_bench.h"

namespace recorder {
namespace {

using RecorderTest = RecorderBench;

// A frame each 100 ms, the first at the begin of each second: 100 of before and 50 of after.
TEST_F(RecorderTest, HoldsTheFramesOfTenSecondsBeforeAndFiveAfter) {
  start();
  run(20s);
  trip();
  run(10s);
  await_kept(1);
  const std::vector<std::string> lines = lines_of(records()[0].stem);
  ASSERT_EQ(lines.size(), 150U);
  EXPECT_EQ(lines.front(), "(1767323055.000000) can0 185#65");
  EXPECT_EQ(lines.back(), "(1767323069.900000) can0 185#FA");
  const boost::json::value json = json_of(records()[0].stem);
  EXPECT_EQ(json.at("ts").as_string(), "2026-01-02T03:04:25.000Z");
  EXPECT_EQ(json.at("from").as_string(), "2026-01-02T03:04:15.000Z");
  EXPECT_EQ(json.at("until").as_string(), "2026-01-02T03:04:30.000Z");
  EXPECT_EQ(json.at("frames").as_int64(), 150);
  EXPECT_TRUE(json.at("ended").is_null());
}

// All in-process buses have one interface: by that a log would be read with the drives of another.
TEST_F(RecorderTest, AnInProcessBusIsNamedInItsLog) {
  for (config::Bus& bus : model_.buses) {
    bus.interface = config::kVirtualInterface;
  }
  start();
  trip();
  run(6s);
  await_kept(1);
  EXPECT_EQ(lines_of(records()[0].stem).front(), "(1767323045.000000) can0 185#01");
  EXPECT_EQ(json_of(records()[0].stem).at("interface").as_string(), "can0");
}

TEST_F(RecorderTest, BeforeAndAfterAreAsConfigured) {
  model_.recorder->before = 1s;
  model_.recorder->after = 0s;
  start();
  run(20s);
  trip();
  run(1s);
  await_kept(1);
  EXPECT_EQ(lines_of(records()[0].stem).size(), 11U);
}

TEST_F(RecorderTest, ARecordSoonAfterAnotherHasItsOwnTenSecondsBefore) {
  start();
  run(20s);
  trip();
  run(5s);
  await_kept(1);
  trip();
  run(6s);
  await_kept(2);
  EXPECT_EQ(lines_of(records()[1].stem).size(), 150U);
}

TEST_F(RecorderTest, TheAlarmNamesItOnceItIsWhole) {
  start();
  trip();
  bench_.hang();
  run(5s);
  bench_.await_hanging();
  EXPECT_EQ(plant_->bus_alarm(0).record, "");
  bench_.go_on();
  const canopen::WallTime ts = plant_->bus_alarm(0).ts;
  await_kept(1);
  EXPECT_EQ(plant_->bus_alarm(0).record, records()[0].stem + ".log");
  EXPECT_EQ(plant_->bus_alarm(0).ts, ts);
  trip();
  EXPECT_EQ(plant_->bus_alarm(0).record, "") << "another activation has none yet";
}

TEST_F(RecorderTest, AnAlarmThatIsOverNamesItToo) {
  start();
  trip();
  set_bus(canopen::BusCondition::error_active);
  pass(5s);
  await_kept(1);
  EXPECT_FALSE(plant_->bus_alarm(0).active);
  EXPECT_EQ(plant_->bus_alarm(0).record, records()[0].stem + ".log");
}

TEST_F(RecorderTest, FaultsWithinARecordAreAddedToIt) {
  start();
  trip();
  run(3s);
  trip();
  run(3s);
  await_kept(1);
  const boost::json::value json = json_of(records()[0].stem);
  ASSERT_EQ(json.at("alarms").as_array().size(), 2U);
  EXPECT_TRUE(json.at("alarms").at(0).at("alarm").at("active").as_bool());
  EXPECT_FALSE(json.at("alarms").at(0).at("at_end").at("active").as_bool());
  EXPECT_TRUE(json.at("alarms").at(1).at("at_end").at("active").as_bool());
  EXPECT_EQ(plant_->bus_alarm(0).record, records()[0].stem + ".log");
  EXPECT_EQ(lines_of(records()[0].stem).size(), 50U) << "it ends when it was to";
}

// It is the record of the cause, and is to be kept longest.
TEST_F(RecorderTest, AFirstFaultThatSoftensMeanwhileStaysTheFirst) {
  start();
  trip();
  const std::string id = plant_->bus_alarm(0).id;
  run(2s);
  set_bus(canopen::BusCondition::passive);
  ASSERT_EQ(plant_->bus_alarm(0).id, id);
  ASSERT_FALSE(plant_->bus_alarm(0).first);
  run(4s);
  await_kept(1);
  EXPECT_TRUE(records()[0].summary.first);
  const boost::json::value alarm = json_of(records()[0].stem).at("alarms").at(0);
  EXPECT_TRUE(alarm.at("alarm").at("first").as_bool());
  EXPECT_EQ(alarm.at("alarm").at("severity").as_string(), "fault");
  EXPECT_EQ(alarm.at("at_end").at("severity").as_string(), "warning");
  EXPECT_EQ(json_of(records()[0].stem).at("alarms").as_array().size(), 1U);
}

TEST_F(RecorderTest, WhatTrippedADriveIsThereAlsoWhereItWasResetMeanwhile) {
  start();
  trip();
  const std::string text = plant_->bus_alarm(0).errors.at(0).text;
  run(2s);
  set_bus(canopen::BusCondition::error_active);
  ASSERT_TRUE(plant_->bus_alarm(0).errors.empty());
  run(4s);
  await_kept(1);
  const boost::json::value alarm = json_of(records()[0].stem).at("alarms").at(0);
  EXPECT_EQ(alarm.at("alarm").at("errors").at(0).at("text").as_string(), text);
  EXPECT_TRUE(alarm.at("at_end").at("errors").as_array().empty());
}

TEST_F(RecorderTest, EachBusHasItsOwn) {
  start();
  set_bus(canopen::BusCondition::error_active, 1);
  trip(0);
  trip(1);
  run(6s);
  await_kept(2);
  EXPECT_EQ(json_of(records()[0].stem).at("bus").as_string(), "can0");
  EXPECT_EQ(json_of(records()[1].stem).at("bus").as_string(), "can1");
  EXPECT_EQ(lines_of(records()[1].stem).size(), 0U);
  EXPECT_TRUE(records()[0].summary.first);
  EXPECT_FALSE(records()[1].summary.first);
}

TEST_F(RecorderTest, TwoOfOneMomentHaveTwoNames) {
  model_.buses[1].name = "can0-bus";
  model_.drives[0].name = model_.buses[0].name;  // a request for either is called the same
  start();
  ASSERT_TRUE(recorder_->request(0, "", "alice").has_value());
  ASSERT_TRUE(recorder_->request(1, "can0", "alice").has_value());
  pass(6s);
  await_kept(2);
  EXPECT_EQ(records()[0].stem, "20260102T030405.000Z-can0-request");
  EXPECT_EQ(records()[1].stem, "20260102T030405.001Z-can0-request");
}

TEST_F(RecorderTest, WarningsAreNotRecorded) {
  start();
  set_bus(canopen::BusCondition::passive);
  ASSERT_TRUE(plant_->bus_alarm(0).active);
  pass(10s);
  EXPECT_TRUE(records().empty());
  set_bus(canopen::BusCondition::bus_off);
  pass(6s);
  await_kept(1);
  EXPECT_EQ(records()[0].stem, "20260102T030415.000Z-can0-bus") << "that of the fault";
}

TEST_F(RecorderTest, AnAlarmOfBeforeTheStartIsNotRecorded) {
  make();
  set_bus(canopen::BusCondition::bus_off);
  const alarms::Alarm before = plant_->bus_alarm(0);
  ASSERT_TRUE(before.active);
  recorder_->start();
  ASSERT_TRUE(loop_.run_until([&] { return recorder_->keeper().records().has_value(); }));
  set_bus(canopen::BusCondition::bus_off);
  pass(10s);
  EXPECT_TRUE(records().empty());
  trip();
  pass(6s);
  await_kept(1);
  EXPECT_EQ(records()[0].stem, "20260102T030415.000Z-can0-bus") << "that of the one after the start";
}

TEST_F(RecorderTest, ADriveThatIsLostIsRecordedByItsName) {
  start();
  for (const auto& bus : buses_) {
    bus->start();
  }
  plant_->start();
  pass(20s);
  await_kept(2);
  EXPECT_EQ(records()[0].name.subject, "pump1");
  EXPECT_EQ(records()[0].name.kind, "heartbeat");
  const boost::json::value json = json_of(records()[0].stem);
  EXPECT_EQ(json.at("drive").as_string(), "pump1");
  EXPECT_EQ(json.at("alarms").at(0).at("kind").as_string(), "heartbeat");
  EXPECT_EQ(plant_->drive(0).alarm(alarms::AlarmKind::heartbeat).record, records()[0].stem + ".log");
  const auto stopped = loop_.start(plant_->stop());
  ASSERT_TRUE(loop_.run_until([&] { return *stopped; }));
}

TEST_F(RecorderTest, WaitsForFramesThatStillComeWhereTheLoopLagsBehind) {
  start();
  lag_ = 300ms;
  trip();
  run(5s);
  run(100ms);
  recorder_->ring(0).on_frame({support::frame(0x285), canopen::Clock::now() - 200ms, canopen::wall_now() - 200ms},
                              canopen::FrameOrigin::others);
  run(1s);
  await_kept(1);
  EXPECT_NE(bench_.text_of(records()[0].stem + ".log").find(" 285#00\n"), std::string::npos);
}

TEST_F(RecorderTest, AFaultBehindTheEndOfOneThatStillWaitsHasItsOwn) {
  start();
  lag_ = 300ms;
  trip();
  run(5100ms);
  ASSERT_TRUE(records().empty());
  trip();
  run(6s);
  await_kept(2);
  EXPECT_EQ(records()[1].stem, "20260102T030410.100Z-can0-bus");
  EXPECT_EQ(json_of(records()[0].stem).at("alarms").as_array().size(), 1U);
  EXPECT_EQ(plant_->bus_alarm(0).record, records()[1].stem + ".log");
}

TEST_F(RecorderTest, LostFramesAreTold) {
  start();
  run(1s);
  recorder_->ring(0).on_frames_lost(7);
  run(1s);
  recorder_->ring(0).on_frames_lost(3);
  trip();
  run(6s);
  await_kept(1);
  const boost::json::value json = json_of(records()[0].stem);
  EXPECT_EQ(json.at("frames_lost").as_int64(), 10);
  EXPECT_EQ(json.at("gaps").as_array().size(), 2U);
  EXPECT_EQ(json.at("gaps").at(0).at("ts").as_string(), "2026-01-02T03:04:06.000Z");
}

TEST_F(RecorderTest, TheEndOfTheGatewayEndsWhatIsUnderWay) {
  start();
  run(5s);
  trip();
  run(1s);
  end();
  const std::string stem = "20260102T030410.000Z-can0-bus";
  EXPECT_EQ(bench_.names(), (std::vector{stem + ".json", stem + ".log"}));
  EXPECT_EQ(lines_of(stem).size(), 60U);
  EXPECT_EQ(json_of(stem).at("ended").as_string(), "the gateway ended");
  EXPECT_EQ(plant_->bus_alarm(0).record, stem + ".log");
}

TEST_F(RecorderTest, AnAlarmNamesNoRecordThatIsGone) {
  start();
  trip();
  pass(6s);
  await_kept(1);
  ASSERT_NE(plant_->bus_alarm(0).record, "");
  set_bus(canopen::BusCondition::bus_off);
  std::filesystem::remove_all(bench_.state());
  ASSERT_TRUE(recorder_->request(1, "", "alice").has_value());
  pass(6s);
  ASSERT_TRUE(loop_.run_until([&] { return plant_->bus_alarm(0).record.empty(); }));
}

TEST_F(RecorderTest, AnAlarmNamesNoRecordWhoseLogSomebodyRemoved) {
  start();
  trip();
  pass(6s);
  await_kept(1);
  ASSERT_TRUE(std::filesystem::remove(bench_.records() / plant_->bus_alarm(0).record));
  recorder_->look_again();
  ASSERT_TRUE(loop_.run_until([&] { return records().empty(); }));
  EXPECT_EQ(plant_->bus_alarm(0).record, "");
  EXPECT_TRUE(bench_.names().empty());
}

// A plant that has another configuration gives it the alarms of before.
TEST_F(RecorderTest, WhatIsHandedOverToAChangedDriveOrBusBeginsNothing) {
  start();
  plant_->start();
  trip();
  pass(30s);  // The drives never appeared.
  await_kept(2);
  const std::string of_bus = plant_->bus_alarm(0).record;
  const std::string of_drive = plant_->drive(0).alarm(alarms::AlarmKind::heartbeat).record;
  ASSERT_FALSE(of_bus.empty());
  ASSERT_FALSE(of_drive.empty());
  config::Model now = model_;
  now.buses[0].sdo_load = 0.5;
  now.drives[1].commands.lease = 5s;
  support::change_plant(loop_.hand(), *plant_, now, {{buses_[0].get(), {}}, {buses_[1].get(), {}}});
  set_bus(canopen::BusCondition::bus_off);
  pass(30s);
  EXPECT_EQ(records().size(), 2U);
  EXPECT_EQ(plant_->bus_alarm(0).record, of_bus);
  EXPECT_EQ(plant_->drive(0).alarm(alarms::AlarmKind::heartbeat).record, of_drive);
  trip();
  pass(10s);
  await_kept(3);  // One that does begin is recorded as before.
  const auto stopped = loop_.start(plant_->stop());
  ASSERT_TRUE(loop_.run_until([&] { return *stopped; }));
}

TEST_F(RecorderTest, ANewOneKnowsWhichFaultsBeganBeforeIt) {
  make();
  set_bus(canopen::BusCondition::bus_off);
  ASSERT_TRUE(plant_->bus_alarm(0).active);
  recorder_->start();
  ASSERT_TRUE(loop_.run_until([&] { return recorder_->keeper().records().has_value(); }));
  plant_->set_bus_record(0, "another.log");
  pass(10s);
  EXPECT_TRUE(records().empty());
}

}  // namespace
}  // namespace recorder
