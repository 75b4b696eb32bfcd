#include "bridges/alarms/alarm_json.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>

namespace alarms {
namespace {

using namespace std::chrono;

Alarm overcurrent() {
  Alarm alarm;
  alarm.active = true;
  alarm.id = "pump1-7";
  alarm.code = 0x0005;
  alarm.text = "Overcurrent during acceleration";
  alarm.error_register = 1;
  alarm.vendor = {5, 0, 0, 0, 0};
  alarm.since = sys_days(2026y / January / 2) + 3h;
  alarm.ts = alarm.since + 678ms;
  alarm.count = 3;
  alarm.known = true;
  alarm.first = true;
  alarm.errors = {{alarm.code, alarm.vendor, alarm.text, config::Severity::fault, alarm.since}};
  return alarm;
}

TEST(AlarmJson, IsThatOfTheContract) {
  EXPECT_EQ(alarm_json(overcurrent()),
            R"({"active":true,"id":"pump1-7","code":"0x0005","reason":"","text":"Overcurrent during acceleration",)"
            R"("severity":"fault","register":"0x01","vendor":"0500000000","since":"2026-01-02T03:00:00.000Z",)"
            R"("ts":"2026-01-02T03:00:00.678Z","count":3,"confirmed":true,"first":true,)"
            R"("errors":[{"code":"0x0005","vendor":"0500000000","severity":"fault",)"
            R"("text":"Overcurrent during acceleration","since":"2026-01-02T03:00:00.000Z"}]})");
}

TEST(AlarmJson, OfOneThatIsOverSaysWhen) {
  Alarm alarm = overcurrent();
  alarm.active = false;
  alarm.cleared = alarm.since + 1h;
  alarm.errors.clear();
  const std::string json = alarm_json(alarm);
  EXPECT_NE(json.find(R"("active":false)"), std::string::npos);
  EXPECT_NE(json.find(R"("cleared":"2026-01-02T04:00:00.000Z")"), std::string::npos);
  EXPECT_NE(json.find(R"("errors":[])"), std::string::npos);
}

TEST(AlarmJson, OfOneThatNeverWasHasNoTimes) {
  const std::string json = alarm_json({});
  EXPECT_NE(json.find(R"("since":null,"ts":null,"cleared":null,"count":0)"), std::string::npos) << json;
}

TEST(AlarmJson, NamesTheRecordWhereThereIsOne) {
  Alarm alarm;
  EXPECT_EQ(alarm_json(alarm).find("record"), std::string::npos);
  alarm.record = "20260102T030405.678Z-pump1-emcy.log";
  EXPECT_NE(alarm_json(alarm).find(R"("record":"20260102T030405.678Z-pump1-emcy.log")"), std::string::npos);
}

}  // namespace
}  // namespace alarms
