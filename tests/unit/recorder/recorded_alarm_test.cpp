#include <gtest/gtest.h>

#include <cstdint>

#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

alarms::Alarm state_of(config::Severity severity, bool first, std::initializer_list<std::uint16_t> codes = {0x2310}) {
  alarms::Alarm alarm;
  alarm.active = codes.size() > 0;
  alarm.severity = severity;
  alarm.first = first;
  for (const std::uint16_t code : codes) {
    alarm.errors.push_back({.code = code, .text = {}, .severity = severity});
  }
  return alarm;
}

RecordedAlarm begun(const alarms::Alarm& alarm) {
  return {"pump1", alarms::AlarmKind::emcy, alarm, alarm};
}

TEST(RecordedAlarmState, IsFirstAlsoWhenItIsOver) {
  RecordedAlarm alarm = begun(state_of(config::Severity::fault, true));
  alarm.change(state_of(config::Severity::warning, false));
  alarm.change(state_of(config::Severity::fault, false));
  alarm.change(state_of(config::Severity::fault, false, {}));
  EXPECT_TRUE(alarm.alarm.first);
  EXPECT_TRUE(alarm.alarm.active);
  EXPECT_FALSE(alarm.at_end.active);
}

TEST(RecordedAlarmState, IsFirstNoMoreWhereAnotherCameBefore) {
  RecordedAlarm alarm = begun(state_of(config::Severity::fault, true));
  alarm.change(state_of(config::Severity::fault, false));
  EXPECT_FALSE(alarm.alarm.first);
  alarm.change(state_of(config::Severity::fault, true));
  EXPECT_TRUE(alarm.alarm.first);
}

TEST(RecordedAlarmState, HasEachErrorThatCameOnce) {
  RecordedAlarm alarm = begun(state_of(config::Severity::fault, true));
  alarm.change(state_of(config::Severity::fault, true, {0x2310, 0x3210}));
  alarm.change(state_of(config::Severity::fault, true, {0x4210}));
  alarm.change(state_of(config::Severity::fault, true, {0x3210}));
  ASSERT_EQ(alarm.alarm.errors.size(), 3U);
  EXPECT_EQ(alarm.alarm.errors.at(0).code, 0x2310);
  EXPECT_EQ(alarm.alarm.errors.at(1).code, 0x3210);
  EXPECT_EQ(alarm.alarm.errors.at(2).code, 0x4210);
  for (std::uint16_t code = 1; code < 1000; ++code) {
    alarm.change(state_of(config::Severity::fault, true, {code}));
  }
  EXPECT_EQ(alarm.alarm.errors.size(), RecordedAlarm::kMostErrors);
}

}  // namespace
}  // namespace recorder
