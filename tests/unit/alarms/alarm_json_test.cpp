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
  alarm.errors = {{alarm.code, alarm.vendor, alarm.text, config::Severity::fault, alarm.since}};
  return alarm;
}

TEST(AlarmJson, IsThatOfTheContract) {
  EXPECT_EQ(
      alarm_json(overcurrent()),
      R"({"active":true,"id":"pump1-7","code":"0x0005","text":"Overcurrent during acceleration",)"
      R"("severity":"fault","register":"0x01","vendor":"0500000000","since":"2026-01-02T03:00:00.000Z",)"
      R"("ts":"2026-01-02T03:00:00.678Z","count":3,"confirmed":true,)"
      R"("errors":[{"code":"0x0005","text":"Overcurrent during acceleration","since":"2026-01-02T03:00:00.000Z"}]})");
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

TEST(AlarmJson, ReadsBackWhatItWrote) {
  const Alarm alarm = overcurrent();
  EXPECT_EQ(parse_alarm(alarm_json(alarm)), alarm);
  Alarm over = alarm;
  over.active = false;
  over.cleared = alarm.since + 1h;
  over.errors.clear();
  EXPECT_EQ(parse_alarm(alarm_json(over)), over);
  EXPECT_EQ(parse_alarm(alarm_json({})), Alarm{});
}

TEST(AlarmJson, ReadsBackTextsOfAnyCharacters) {
  Alarm alarm = overcurrent();
  alarm.text = "\"quoted\" \\ \n \xC3\xBC";
  alarm.errors[0].text = alarm.text;
  EXPECT_EQ(parse_alarm(alarm_json(alarm)), alarm);
}

TEST(AlarmJson, ShowsBytesThatAreNoTextAsReplacement) {
  Alarm alarm = overcurrent();
  alarm.text = "a\xFFz";
  const auto read = parse_alarm(alarm_json(alarm));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->text, "a\xEF\xBF\xBDz");
}

TEST(AlarmJson, OtherErrorsOfTheListTakeTheSeverityOfTheAlarm) {
  Alarm alarm = overcurrent();
  alarm.errors.push_back({0x2310, {1, 2, 3, 4, 5}, "Other", config::Severity::warning, alarm.since});
  const auto read = parse_alarm(alarm_json(alarm));
  ASSERT_TRUE(read);
  ASSERT_EQ(read->errors.size(), 2U);
  EXPECT_EQ(read->errors[0].vendor, alarm.vendor);
  EXPECT_EQ(read->errors[1].vendor, (std::array<std::uint8_t, 5>{}));
  EXPECT_EQ(read->errors[1].severity, config::Severity::fault);
}

TEST(AlarmJson, ReadsNothingElse) {
  const std::string good = alarm_json(overcurrent());
  const auto with = [&good](std::string_view from, std::string_view to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  for (const std::string& text : {std::string(),
                                  std::string("null"),
                                  std::string("[]"),
                                  std::string("{}"),
                                  std::string("{\"active\":true}"),
                                  std::string("\xFF"),
                                  good + "x",
                                  good.substr(0, good.size() - 1),
                                  with("true", "1"),
                                  with("0x0005", "5"),
                                  with("0x0005", "0x00005"),
                                  with("0x01", "0xG1"),
                                  with("0500000000", "05"),
                                  with("\"fault\"", "\"bad\""),
                                  with("2026-01-02T03:00:00.000Z", "today"),
                                  with("\"count\":3", "\"count\":-3"),
                                  with("\"count\":3", "\"count\":4294967296"),
                                  with("\"count\":3", "\"count\":3.5"),
                                  with("\"errors\":[{", "\"x\":[{"),
                                  std::string(100'000, '['),
                                  std::string(70'000, ' ')}) {
    EXPECT_FALSE(parse_alarm(text)) << text.substr(0, 200);
  }
}

}  // namespace
}  // namespace alarms
