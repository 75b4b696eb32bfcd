#include "bridges/alarms/alarm_reader.h"

#include <gtest/gtest.h>

#include <array>
#include <boost/json/parse.hpp>
#include <chrono>
#include <string>
#include <utility>
#include <vector>

#include "bridges/alarms/alarm_json.h"

namespace alarms {
namespace {

using namespace std::chrono;

Alarm two_errors() {
  Alarm alarm;
  alarm.active = true;
  alarm.known = true;
  alarm.id = "00FF00FF00FF00FF";
  alarm.code = 0x2310;
  alarm.reason = "word";
  alarm.text = "Overcurrent";
  alarm.error_register = 3;
  alarm.vendor = {1, 2, 3, 4, 0xAB};
  alarm.since = sys_days(2026y / January / 2) + 3h;
  alarm.ts = alarm.since + 678ms;
  alarm.count = 3;
  alarm.first = true;
  alarm.errors = {{0x2310, {9}, "Other", config::Severity::warning, alarm.since},
                  {0x2310, alarm.vendor, alarm.text, config::Severity::fault, alarm.since + 1ms}};
  return alarm;
}

ReadAlarm read(std::string_view text) {
  return read_alarm(boost::json::parse(boost::json::string_view(text.data(), text.size())));
}

void expect_read_back(const Alarm& alarm) {
  const ReadAlarm back = read(alarm_json(alarm));
  EXPECT_EQ(back.wrong, "");
  EXPECT_EQ(back.alarm, alarm);
}

TEST(AlarmReader, ReadsBackWhatWasWritten) {
  expect_read_back(two_errors());
  Alarm over = two_errors();
  over.active = false;
  over.cleared = over.since + 1h;
  over.errors.clear();
  expect_read_back(over);
  Alarm never;
  never.known = true;
  expect_read_back(never);
}

TEST(AlarmReader, ReadsBackTextsOfAnyCharacters) {
  Alarm alarm = two_errors();
  alarm.text = "\"quoted\" \\ \n \xC3\xBC";
  alarm.errors[1].text = alarm.text;
  expect_read_back(alarm);
}

TEST(AlarmReader, BytesThatAreNoTextAreReplaced) {
  Alarm alarm = two_errors();
  alarm.text = "a\xFFz";
  EXPECT_EQ(read(alarm_json(alarm)).alarm.text, "a\xEF\xBF\xBDz");
}

TEST(AlarmReader, PassesOverMembersOfALaterVersion) {
  std::string text = alarm_json(two_errors());
  text.insert(1, R"("trace":"x.log","later":[1],)");
  EXPECT_EQ(read(text).wrong, "");
  EXPECT_EQ(read(text).alarm, two_errors());
}

TEST(AlarmReader, KnowsTheRecordWhereThereIsOne) {
  Alarm alarm = two_errors();
  alarm.record = "x.log";
  EXPECT_EQ(read(alarm_json(alarm)).alarm, alarm);
  std::string text = alarm_json(two_errors());
  text.insert(1, R"("record":7,)");
  EXPECT_EQ(read(text).wrong, R"("record" is not a text)");
}

TEST(AlarmReader, TellsWhatIsWrong) {
  const std::string good = alarm_json(two_errors());
  const std::vector<std::array<std::string, 3>> cases{
      {"\"active\":true", "\"active\":1", R"("active" is not true or false)"},
      {"\"id\":\"00FF00FF00FF00FF\"", "\"id\":7", R"("id" is not a text)"},
      {"\"id\":\"00FF00FF00FF00FF\"", "\"id\":\"\"", R"("id" is not there)"},
      {"\"id\"", "\"x\"", R"("id" is not a text)"},
      {"\"code\":\"0x2310\"", "\"code\":\"2310\"", R"("code" is not 0x and four hexadecimal digits)"},
      {"\"code\":\"0x2310\"", "\"code\":\"0x02310\"", R"("code" is not)"},
      {"\"reason\":\"word\",", "", R"("reason" is not a text)"},
      {"\"severity\":\"fault\"", "\"severity\":\"bad\"", R"("severity" is not fault or warning)"},
      {"\"0x03\"", "\"0xG3\"", R"("register" is not 0x and two hexadecimal digits)"},
      {"\"vendor\":\"01020304AB\"", "\"vendor\":\"01\"", R"("vendor" is not ten hexadecimal digits)"},
      {"2026-01-02T03:00:00.678Z", "today", R"("ts" is not a time or null)"},
      {"\"count\":3", "\"count\":-3", R"("count" is not a number from 0 to 4294967295)"},
      {"\"count\":3", "\"count\":4294967296", R"("count" is not)"},
      {"\"count\":3", "\"count\":3.5", R"("count" is not)"},
      {"\"count\":3", "\"count\":0", R"("id" is not there, or "count" is 0)"},
      {"\"first\":true", "\"first\":null", R"("first" is not true or false)"},
      {"\"errors\":[{", "\"x\":[{", R"("errors" is not a list)"},
      {"\"errors\":[{", "\"errors\":[1,{", R"("errors" is not a list of objects)"},
      {"\"vendor\":\"0900000000\",", "", R"("errors" is not in order: "vendor" is not ten hexadecimal digits)"},
      {"\"active\":true", "\"active\":false", R"("cleared" is not a time or null)"},
      {"\"active\":true", "\"cleared\":null,\"active\":false", R"("errors" is not what "active" says)"}};
  for (const auto& [from, to, wrong] : cases) {
    std::string text = good;
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
    EXPECT_EQ(read(text).wrong.substr(0, wrong.size()), wrong) << text;
    EXPECT_FALSE(read(text).wrong.empty());
  }
  for (const char* text : {"null", "[]", "1", "\"x\""}) {
    EXPECT_EQ(read(text).wrong, "it is no object");
  }
  EXPECT_FALSE(read("{}").wrong.empty());
}

}  // namespace
}  // namespace alarms
