#include "bridges/recorder/record_text.h"

#include <gtest/gtest.h>

#include <boost/json/parse.hpp>
#include <string>

#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

TEST(RecordJson, TellsWhatHappened) {
  Record record = record_of(0, 3, true);
  record.bitrate = 250'000;
  LogFigures log{.frames = 3, .error_frames = 1, .lost = 7, .gaps = {{wall_at(1), 7}}};
  const std::string text = record_json(record, log);
  const boost::json::object json = boost::json::parse(text).as_object();
  EXPECT_EQ(json.at("name").as_string(), "20260102T030405.000Z-pump1-emcy.log");
  EXPECT_EQ(json.at("bus").as_string(), "can0");
  EXPECT_EQ(json.at("drive").as_string(), "pump1");
  EXPECT_EQ(json.at("bitrate").as_int64(), 250'000);
  EXPECT_TRUE(json.at("requested_by").is_null());
  EXPECT_TRUE(json.at("first").as_bool());
  EXPECT_EQ(json.at("frames_lost").as_int64(), 7);
  EXPECT_EQ(json.at("gaps").at(0).at("ts").as_string(), "2026-01-02T03:04:06.000Z");
  EXPECT_EQ(json.at("alarms").at(0).at("drive").as_string(), "pump1");
  EXPECT_EQ(json.at("alarms").at(0).at("kind").as_string(), "emcy");
  EXPECT_EQ(json.at("alarms").at(0).at("alarm").at("id").as_string(), "00FF00FF00FF00FF");
  EXPECT_EQ(json.at("commands").at(0).at("writer").as_string(), "local");
}

TEST(RecordJson, IsReadBackForTheList) {
  const std::string text = record_json(record_of(0, 3, true), {.frames = 3});
  EXPECT_EQ(parse_summary(text), (RecordSummary{"can0", "pump1", true, 3, 1}));
  Record of_bus = record_of(0);
  of_bus.drive.clear();
  of_bus.alarms.at(0).kind.reset();
  EXPECT_EQ(parse_summary(record_json(of_bus, {})), (RecordSummary{"can0", "", false, 0, 1}));
}

TEST(RecordJson, AnythingElseIsNone) {
  for (const char* text :
       {"", "{", "[]", "7", "{}", R"({"version":2,"bus":"can0"})", R"({"version":1})", R"({"version":1,"bus":7})",
        R"({"version":1,"bus":"../.."})", R"({"version":1,"bus":""})", R"({"version":1,"bus":"can0","drive":"a/b"})"}) {
    EXPECT_FALSE(parse_summary(text)) << text;
  }
  EXPECT_EQ(parse_summary(R"({"version":1,"bus":"can0","frames":-1,"first":"yes","commands":{}})"),
            (RecordSummary{"can0", "", false, 0, 0}));
}

}  // namespace
}  // namespace recorder
