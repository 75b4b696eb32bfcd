#include <gtest/gtest.h>

#include <cerrno>
#include <string>

#include "tests/unit/recorder/recorder_bench.h"

namespace recorder {
namespace {

class RecorderLimits : public RecorderBench {
 protected:
  void trip_and_keep(std::size_t count) {
    trip();
    pass(6s);
    await_kept(count);
  }
};

TEST_F(RecorderLimits, TenOfABusAnHourAndThatIsToldOnce) {
  start();
  for (std::size_t i = 1; i <= 10; ++i) {
    trip_and_keep(i);
  }
  EXPECT_TRUE(warnings_.empty());
  for (int i = 0; i < 3; ++i) {
    trip();
    pass(6s);
  }
  EXPECT_EQ(records().size(), 10U);
  EXPECT_EQ(warnings_, std::vector<std::string>{"bus can0: 10 records of faults within an hour; further ones are not "
                                                "recorded until the first is an hour old"});
  EXPECT_EQ(plant_->bus_alarm(0).record, "");
  pass(1h);
  infos_.clear();
  trip_and_keep(11);
  EXPECT_EQ(records().back().stem, "20260102T040523.000Z-can0-bus") << "none of those before";
  ASSERT_FALSE(infos_.empty());
  EXPECT_EQ(infos_.front(), "bus can0: is recorded again; 3 faults were not recorded");
}

TEST_F(RecorderLimits, AnotherBusIsNotLimitedByThat) {
  start();
  for (std::size_t i = 1; i <= 10; ++i) {
    trip_and_keep(i);
  }
  trip(1);
  pass(6s);
  await_kept(11);
}

TEST_F(RecorderLimits, RequestsHaveALimitOfTheirOwn) {
  start();
  for (std::size_t i = 1; i <= 10; ++i) {
    ASSERT_TRUE(recorder_->request(0, "pump1", "alice").has_value());
    pass(6s);
    await_kept(i);
  }
  const auto refused = recorder_->request(0, "pump1", "alice");
  ASSERT_TRUE(refused.has_error());
  EXPECT_EQ(refused.error().kind, canopen::ErrorKind::forbidden);
  trip_and_keep(11);
  EXPECT_EQ(json_of(records()[0].stem).at("requested_by").as_string(), "alice");
}

TEST_F(RecorderLimits, ARequestDuringARecordNamesThatOne) {
  start();
  trip();
  pass(2s);
  const auto requested = recorder_->request(0, "", "alice");
  ASSERT_TRUE(requested.has_value());
  EXPECT_TRUE(requested.value().was_under_way);
  EXPECT_EQ(requested.value().remaining, 3s);
  pass(4s);
  await_kept(1);
  EXPECT_EQ(requested.value().name, records()[0].stem + ".log");
}

TEST_F(RecorderLimits, AStormOfFaultsWithinARecordIsCounted) {
  start();
  for (std::size_t i = 0; i < Record::kMostAlarms + 7; ++i) {
    trip();
  }
  pass(6s);
  await_kept(1);
  const boost::json::value json = json_of(records()[0].stem);
  EXPECT_EQ(json.at("alarms").as_array().size(), Record::kMostAlarms);
  EXPECT_EQ(json.at("alarms_left_out").as_int64(), 7);
}

TEST_F(RecorderLimits, AFullDiskIsSurvived) {
  start();
  bench_.refuse(RecordBench::Call::write, ENOSPC);
  trip();
  pass(6s);
  ASSERT_TRUE(loop_.run_until([&] { return !warnings_.empty(); }));
  EXPECT_NE(warnings_[0].find("No space left on device"), std::string::npos);
  EXPECT_EQ(plant_->bus_alarm(0).record, "");
  bench_.accept();
  pass(6s);
  await_kept(1);
  EXPECT_EQ(plant_->bus_alarm(0).record, records()[0].stem + ".log");
}

}  // namespace
}  // namespace recorder
