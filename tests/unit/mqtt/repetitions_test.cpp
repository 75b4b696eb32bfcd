// Commands that come twice: what is a repetition, and what it is told.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/spawn.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::PlantSite;

constexpr std::string_view kFrequencySet = "canopen/line3/pump1/frequency_command/set";

std::string duplicate_of(const std::string& first, const std::string& end) {
  return R"({"ok":false,"code":"duplicate","error":"the same command came within the last 60 s","first":)" + first +
         R"(,"topic":")" + std::string(kFrequencySet) + "\"" + end + "}";
}

std::string code_of(const std::string& answer) {
  const std::size_t start = answer.find("\"code\":\"");
  return start == std::string::npos ? answer : answer.substr(start + 8, answer.find('"', start + 8) - start - 8);
}

config::Model leased_model() {
  config::Model model = PlantSite::bridge_model();
  model.drives[0].commands.lease = 10s;
  model.drives[0].commands.writers.modbus = true;
  model.drives[0].commands.deadline = 800ms;
  return model;
}

class Repetitions : public testing::Test {
 protected:
  void SetUp() override {
    site_.bring_up_drive();
    site_.connect();
    site_.broker().forget();
  }
  std::string ask(const std::string& topic, const std::string& payload) {
    site_.broker().forget();
    site_.command(topic, payload);
    return site_.last_answer();
  }
  /// Another writer takes the lease.
  void lease_to_modbus() {
    const auto written = support::spawn(
        site_.loop().executor(),
        site_.plant().drive(0).write({.writer = {.way = process::Writer::Way::modbus, .address = "192.0.2.7"}},
                                     {{test::kFrequencyCommand, 20.0}}));
    site_.run(100ms);
    ASSERT_TRUE(written.done());
  }
  [[nodiscard]] std::vector<std::string> answers() { return site_.broker().on("canopen/line3/result"); }

  PlantSite site_{leased_model()};
};

TEST_F(Repetitions, AreToldTheFirstOutcome) {
  const std::string payload = R"({"value":30.0,"id":"a1"})";
  ask("pump1/frequency_command/set", payload);
  EXPECT_EQ(ask("pump1/frequency_command/set", payload), duplicate_of(R"({"ok":true})", R"(,"id":"a1")"));
  EXPECT_EQ(site_.puppet().written.size(), 1U);
}

TEST_F(Repetitions, AreToldWhatTheDriveRefused) {
  site_.puppet().refuse_writes[{0x2031, 0}] = 0x08000022;
  const std::string payload = R"({"value":"torque","id":"a1"})";
  EXPECT_EQ(code_of(ask("pump1/mode/set", payload)), "refused");
  const std::string again = ask("pump1/mode/set", payload);
  EXPECT_NE(again.find(R"("first":{"ok":false,"code":"refused","abort":"0x08000022","error":")"), std::string::npos)
      << again;
}

TEST_F(Repetitions, WaitForTheOutcomeOfTheFirst) {
  site_.puppet().mute = true;
  const std::string payload = R"({"value":30.0,"id":"a1"})";
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(ask("pump1/frequency_command/set", payload), "none");
  }
  site_.loop().advance(1s, 10ms);
  ASSERT_EQ(answers().size(), 3U);
  EXPECT_EQ(code_of(answers()[0]), "timeout");
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_EQ(code_of(answers()[i]), "duplicate");
    EXPECT_NE(answers()[i].find(R"("first":{"ok":false,"code":"timeout","error":")"), std::string::npos);
  }
}

TEST_F(Repetitions, BeyondThoseThatMayWaitAreAnsweredAtOnce) {
  site_.puppet().mute = true;
  const std::string payload = R"({"value":30.0,"id":"a1"})";
  constexpr std::size_t kMoreThanWait = 1000;
  for (std::size_t i = 0; i < 1 + kMoreThanWait; ++i) {
    site_.command("pump1/frequency_command/set", payload);
  }
  EXPECT_TRUE(answers().empty());
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", payload)), "duplicate");
  EXPECT_EQ(site_.last_answer().find("\"first\""), std::string::npos) << site_.last_answer();
  site_.loop().advance(1s, 10ms);
  EXPECT_EQ(answers().size(), 1 + 1 + kMoreThanWait);
}

TEST_F(Repetitions, AreAnsweredWhereTheyWereAskedInTheirForm) {
  const Incoming write{.topic = "canopen/line3/pump1/sdo/request",
                       .payload = R"({"id":"7","op":"write","object":"0x2031:00","type":"u8","value":1})",
                       .response_topic = "answers/7",
                       .correlation = "c"};
  site_.receive(write);
  site_.receive(write);
  const auto there = site_.broker().on("answers/7");
  ASSERT_EQ(there.size(), 2U);
  EXPECT_EQ(there[0], R"({"id":"7","ok":true})");
  EXPECT_EQ(there[1], R"({"id":"7","ok":false,"code":"duplicate","error":"the same command came within the last 60 s",)"
                      R"("first":{"ok":true}})");
  EXPECT_EQ(site_.broker().published.back().correlation, "c");
}

TEST_F(Repetitions, OfWhatWasRefusedUnsentAreNewCommands) {
  const std::string set = R"({"value":30.0,"id":"a1"})";
  lease_to_modbus();
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", set)), "lease");
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", set)), "lease");
  site_.run(10s);
  site_.puppet().mute = true;
  site_.loop().advance(2s, 10ms);
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", set)), "offline");
  site_.puppet().mute = false;
  site_.run(1s);
  ASSERT_TRUE(site_.plant().drive(0).status().online);
  EXPECT_NE(ask("pump1/frequency_command/set", set).find("\"ok\":true"), std::string::npos) << site_.last_answer();
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", set)), "duplicate");
  const std::string too_much = R"({"value":50.01,"id":"a2"})";
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", too_much)), "range");
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", too_much)), "range");
}

TEST_F(Repetitions, OfWhatWasSupersededOrExpiredAreRepetitions) {
  site_.puppet().mute = true;
  site_.command("pump1/control_command/set", "1");
  const std::string waits = R"({"value":30.0,"id":"a1"})";
  site_.command("pump1/frequency_command/set", waits);
  site_.broker().forget();
  site_.command("pump1/frequency_command/set", "40");
  EXPECT_EQ(code_of(site_.last_answer()), "superseded");
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", waits)), "duplicate");
  EXPECT_NE(site_.last_answer().find(R"("first":{"ok":false,"code":"superseded")"), std::string::npos);
  site_.puppet().mute = false;
  Incoming late{.topic = std::string(kFrequencySet), .payload = R"({"value":30.0,"id":"a2"})", .expiry = 0};
  site_.receive(late);
  EXPECT_EQ(code_of(site_.last_answer()), "expired");
  site_.receive(late);
  EXPECT_EQ(code_of(site_.last_answer()), "expired") << "that is told before";
  late.expiry.reset();
  site_.receive(late);
  EXPECT_EQ(code_of(site_.last_answer()), "duplicate");
  EXPECT_NE(site_.last_answer().find(R"("first":{"ok":false,"code":"expired")"), std::string::npos);
}

TEST_F(Repetitions, AreKnownByCorrelationDataToo) {
  Incoming command{.topic = std::string(kFrequencySet), .payload = "30", .correlation = "1"};
  site_.receive(command);
  site_.receive(command);
  EXPECT_EQ(site_.last_answer(), duplicate_of(R"({"ok":true})", ""));
  command.correlation = "2";
  site_.receive(command);
  EXPECT_NE(site_.last_answer().find("\"ok\":true"), std::string::npos) << "another one";
}

TEST_F(Repetitions, AreAnsweredBeforeOneTooManyIs) {
  site_.puppet().mute = true;
  const std::string first = R"({"value":1,"id":"a1"})";
  site_.command("pump1/control_command/set", first);
  for (std::size_t i = 1; i < Requests::kMaxCommands; ++i) {
    site_.command("pump1/control_command/set", "1");
  }
  EXPECT_EQ(ask("pump1/control_command/set", first), "none") << "it waits for the outcome of the first";
  EXPECT_EQ(code_of(ask("pump1/control_command/set", "1")), "timeout");
  site_.loop().advance(1s, 10ms);
  const auto told = answers();
  EXPECT_EQ(std::ranges::count_if(told, [](const std::string& answer) { return code_of(answer) == "duplicate"; }), 1);
}

}  // namespace
}  // namespace mqtt
