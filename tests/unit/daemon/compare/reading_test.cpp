// What `check --live` takes for an answer of a gateway.

#include "daemon/compare/reading.h"

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "daemon/compare/compare.h"

namespace gateway::compare {
namespace {

using testing::ElementsAre;

TEST(ReadRunning, TakesNoOtherAnswer) {
  for (const std::string text : {"", "hello", "[]", "{}", R"({"ok":true})", R"({"status":[]})", R"({"status":{}})",
                                 R"({"status":{"drives":5}})"}) {
    EXPECT_FALSE(read_running(text).has_value()) << text;
  }
  EXPECT_TRUE(read_running(R"({"status":{"drives":[1,{}]}})").has_value());
}

Reading read_answer(const std::string& answer, canopen::DataType type = canopen::DataType::u16) {
  return read_object([&](const std::string&) { return std::optional(answer); }, "pump1", {0x2001, 2}, type);
}

TEST(ReadObject, AsksForItOnceAndTakesItsNumber) {
  std::vector<std::string> requests;
  const Reading reading = read_object(
      [&](const std::string& request) {
        requests.push_back(request);
        return std::optional<std::string>(R"({"id":1,"ok":true,"value":-2})");
      },
      "pump1", {0x2001, 0x0B}, canopen::DataType::i16);
  EXPECT_THAT(requests, ElementsAre(R"({"id":1,"op":"sdo-read","drive":"pump1","object":"0x2001:0B","type":"i16"})"));
  EXPECT_EQ(reading.kind, Reading::Kind::value);
  EXPECT_EQ(canopen::to_number(canopen::DataType::i16, reading.raw), -2.0);
}

TEST(ReadObject, TakesAnotherWidthAsBytes) {
  const Reading reading = read_object(
      [](const std::string& request) {
        return std::optional<std::string>(request.find("bytes") == std::string::npos
                                              ? R"({"id":1,"ok":false,"code":"type","error":"wrong length"})"
                                              : R"({"id":1,"ok":true,"value":"F4010000"})");
      },
      "pump1", {0x1017, 0}, canopen::DataType::u16);
  EXPECT_EQ(reading.kind, Reading::Kind::value);
  EXPECT_EQ(reading.raw, 500U);
}

TEST(ReadObject, TellsWhyThereIsNoValue) {
  using Kind = Reading::Kind;
  EXPECT_EQ(read_answer(R"({"ok":false,"code":"refused","abort":"0x06020000"})").kind, Kind::absent);
  EXPECT_EQ(read_answer(R"({"ok":false,"code":"refused","abort":"0x06090011"})").kind, Kind::absent);
  EXPECT_EQ(read_answer(R"({"ok":false,"code":"refused","abort":"0x06010001","error":"x"})").reason, "x");
  EXPECT_EQ(read_answer(R"({"ok":false,"code":"refused","abort":"0x06010001"})").kind, Kind::unreadable);
  EXPECT_EQ(read_answer(R"({"ok":false,"code":"timeout"})").kind, Kind::silent);
  EXPECT_EQ(read_answer(R"({"ok":false,"code":"offline"})").kind, Kind::silent);
  EXPECT_EQ(read_answer(R"({"ok":true,"value":"AC310"})").kind, Kind::unreadable);
  EXPECT_EQ(read_answer(R"({"ok":true})").kind, Kind::unreadable);
  EXPECT_EQ(read_answer("hello").kind, Kind::silent);
}

}  // namespace
}  // namespace gateway::compare
