#include "bridges/recorder/command_trail.h"

#include <gtest/gtest.h>

#include <boost/json/parse.hpp>
#include <chrono>
#include <string>

#include "tests/support/hand_driven_loop.h"
#include "tests/unit/process/test_drive.h"
#include "tests/unit/recorder/moment.h"

namespace recorder {
namespace {

using namespace std::chrono_literals;

class CommandText : public ::testing::Test {
 protected:
  CommandText() {
    record_.id = "a1";
    record_.writer = {.way = process::Writer::Way::modbus, .address = "192.0.2.7"};
    record_.drive = &drive_;
    record_.arrived = moment(0s);
    record_.wall = canopen::WallTime(1767323045s);
  }
  config::Drive drive_ = process::test::drive();
  process::CommandRecord record_;
};

TEST_F(CommandText, SaysWhoAskedForWhatAndWhatCameOfIt) {
  record_.fields = {{.signal = process::test::id(drive_, "control_command"), .asked = 5, .confirmed = 5}};
  EXPECT_EQ(command_text(record_, {}, moment(12ms)),
            R"({"ts":"2026-01-02T03:04:05.000Z","writer":"modbus","from":"192.0.2.7","drive":"pump1","outcome":"ok",)"
            R"("id":"a1","fields":[{"signal":"control_command","asked":5,"confirmed":5}],"ms":12})");
}

TEST_F(CommandText, StaysShortHoweverMuchWasWritten) {
  record_.kind = process::CommandRecord::Kind::raw;
  record_.object = {{0x2000, 1}, canopen::DataType::u8, 0};
  record_.bytes = std::vector<std::uint8_t>(100'000, 7);
  const std::string text = command_text(record_, canopen::Error{.kind = canopen::ErrorKind::forbidden}, moment(12ms));
  EXPECT_LT(text.size(), 300U);
  EXPECT_EQ(boost::json::parse(text).at("outcome").as_string(), "forbidden");
  EXPECT_TRUE(boost::json::parse(text).at("too_long").as_bool());
}

TEST(CommandTrail, GivesThoseThatWereAnsweredSince) {
  CommandTrail trail;
  for (int i = 0; i < 20; ++i) {
    trail.add(std::to_string(i), moment(i * 1s), moment(i * 1s - 10s));
  }
  const CommandTrail::Taken taken = trail.since(moment(15s));
  EXPECT_EQ(taken.commands, (std::vector<std::string>{"15", "16", "17", "18", "19"}));
  EXPECT_EQ(taken.left_out, 0U);
  EXPECT_EQ(trail.since(moment(0s)).commands.size(), 11U) << "older ones are not wanted";
}

TEST(CommandTrail, LeavesOutTheOldestOfTooManyAndSaysSo) {
  CommandTrail trail;
  for (std::size_t i = 0; i < CommandTrail::kMost + 5; ++i) {
    trail.add(std::to_string(i), moment(i * 1ms), moment(-10s));
  }
  const CommandTrail::Taken taken = trail.since(moment(-10s));
  EXPECT_EQ(taken.commands.size(), CommandTrail::kMost);
  EXPECT_EQ(taken.commands.front(), "5");
  EXPECT_EQ(taken.left_out, 5U);
  EXPECT_EQ(trail.since(moment(3ms)).left_out, 2U);
}

}  // namespace
}  // namespace recorder
