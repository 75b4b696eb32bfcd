// What a command is told first, and in which order commands reach their drive.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "bridges/process/answer.h"
#include "bridges/process/command_journal.h"
#include "tests/support/spawn.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::PlantSite;

constexpr canopen::ObjectAddress kControlWord{0x2000, 1};
const std::string kRoot = "canopen/line3/";

/// Stops as in CiA 402: any word without bit 1 (0), or without bit 2 (quick stop), or shutdown.
config::Model cia402_model() {
  config::Model model = PlantSite::bridge_model();
  config::Drive& drive = model.drives[0];
  drive.node.motor.control = kControlWord;
  drive.node.motor.stops = {
      {.mask = 0xF882, .equals = 0}, {.mask = 0xF884, .equals = 0}, {.mask = 0xF887, .equals = 0x0006}};
  drive.commands.lease = 10s;
  drive.commands.writers.modbus = true;
  return model;
}

config::Model without_mqtt() {
  config::Model model = cia402_model();
  model.drives[0].commands.writers.mqtt = false;
  return model;
}

class Ids final : public process::CommandJournal {
 public:
  boost::asio::awaitable<void> begun(const process::CommandRecord&) override { co_return; }
  void done(const process::CommandRecord& record, const process::Outcome& outcome) override {
    ids.push_back(record.id);
    codes.push_back(outcome.has_value() ? "ok" : std::string(process::answer_of(outcome.error().kind).mqtt_code));
  }

  std::vector<std::string> ids;
  std::vector<std::string> codes;
};

class Site {
 public:
  explicit Site(config::Model model) : site(std::move(model)) {
    site.bring_up_drive();
    site.connect();
    site.broker().forget();
  }
  std::string code(Incoming incoming) {
    site.broker().forget();
    incoming.topic = kRoot + incoming.topic;
    site.receive(std::move(incoming));
    const std::string result = site.last_answer();
    const std::string answer = result == "none" ? site.last_answer(kRoot + "pump1/sdo/response") : result;
    const std::size_t start = answer.find("\"code\":\"");
    return start == std::string::npos ? answer : answer.substr(start + 8, answer.find('"', start + 8) - start - 8);
  }
  /// What was written to `control_command` by SDO.
  [[nodiscard]] std::vector<canopen::Raw> words() {
    std::vector<canopen::Raw> raw;
    for (const canopen::ObjectValue& value : site.puppet().written) {
      if (value.object == kControlWord) {
        raw.push_back(value.raw);
      }
    }
    return raw;
  }
  void lease_to_modbus() {
    const auto written = support::spawn(
        site.loop().executor(),
        site.plant().drive(0).write({.writer = {.way = process::Writer::Way::modbus, .address = "192.0.2.7"}},
                                    {{test::kFrequencyCommand, 20.0}}));
    site.run(100ms);
    ASSERT_TRUE(written.done());
  }

  PlantSite site;
};

/// Each is wrong in a way of its own.
const std::vector<Incoming> kMistakes = {
    {.topic = "pump1/frequency_command/set", .payload = "fast"},
    {.topic = "pump1/frequency_command/set", .payload = "{\"value\":"},
    {.topic = "pump1/frequency_command/set", .payload = "50.01"},
    {.topic = "pump1/output_frequency/set", .payload = "1"},
    {.topic = "pump1/speed/set", .payload = "1"},
    {.topic = "pump1/set", .payload = "30"},
    {.topic = "pump1/nmt/set", .payload = "run"},
    {.topic = "pump1/sdo/request", .payload = R"({"op":"write","object":"here"})"},
    {.topic = "pump1/sdo/request", .payload = "{"},
};

TEST(CommandOrder, WhoMayNotWriteIsToldNothingElse) {
  Site there(without_mqtt());
  for (Incoming mistake : kMistakes) {
    EXPECT_EQ(there.code(mistake), "forbidden") << mistake.topic << " " << mistake.payload;
    mistake.expiry = 0;
    EXPECT_EQ(there.code(mistake), "forbidden") << "before expired: " << mistake.topic << " " << mistake.payload;
    mistake.retained = true;
    EXPECT_EQ(there.code(mistake), "retained") << mistake.topic << " " << mistake.payload;
  }
  EXPECT_EQ(there.code({.topic = "pump1/control_command/set", .payload = "6"}), "forbidden") << "a stop too";
  EXPECT_EQ(there.code({.topic = "pump1/sdo/request", .payload = R"({"op":"read","object":"here"})"}), "type")
      << "reading needs no permission";
}

TEST(CommandOrder, WhatIsForbiddenOrExpiredStandsInTheJournal) {
  Ids journal;
  Incoming command{.topic = "pump1/frequency_command/set", .payload = R"({"value":30.0,"id":"a1"})", .expiry = 0};
  Site closed(without_mqtt());
  closed.site.plant().drive(0).set_journal(&journal);
  EXPECT_EQ(closed.code(command), "forbidden");
  command.response_topic = kRoot + "pump1/set";
  EXPECT_EQ(closed.code(command), "forbidden");
  command.response_topic.clear();
  Site open(cia402_model());
  open.site.plant().drive(0).set_journal(&journal);
  EXPECT_EQ(open.code(command), "expired");
  EXPECT_EQ(journal.ids, (std::vector<std::string>{"a1", "a1", "a1"}));
}

TEST(CommandOrder, ExpiredGoesBeforeAllMistakes) {
  Site there(cia402_model());
  for (Incoming mistake : kMistakes) {
    const std::string code = there.code(mistake);
    EXPECT_TRUE(code == "type" || code == "range" || code == "read-only" || code == "unknown") << code;
    mistake.expiry = 0;
    EXPECT_EQ(there.code(mistake), "expired") << mistake.topic << " " << mistake.payload;
  }
}

TEST(CommandOrder, ExpiredGoesBeforeAllThatIsDone) {
  Site there(cia402_model());
  const std::vector<Incoming> late = {
      {.topic = "pump1/frequency_command/set", .payload = "30"},
      {.topic = "pump1/control_command/set", .payload = "6"},
      {.topic = "pump1/nmt/set", .payload = "start"},
      {.topic = "pump1/sdo/request", .payload = R"({"op":"read","object":"0x2002:03","type":"u16"})"},
      {.topic = "pump1/sdo/request", .payload = R"({"op":"write","object":"0x2031:00","type":"u32","value":1})"},
  };
  for (Incoming command : late) {
    command.expiry = 0;
    EXPECT_EQ(there.code(command), "expired") << command.topic << " " << command.payload;
  }
  EXPECT_TRUE(there.site.puppet().written.empty());
}

TEST(CommandOrder, TheLeaseGoesBeforeAccessTypeAndRange) {
  Site there(cia402_model());
  there.lease_to_modbus();
  for (const char* payload : {"fast", "{\"value\":", "50.01", "30"}) {
    EXPECT_EQ(there.code({.topic = "pump1/frequency_command/set", .payload = payload}), "lease") << payload;
  }
  EXPECT_EQ(there.code({.topic = "pump1/output_frequency/set", .payload = "1"}), "lease");
}

TEST(CommandOrder, ARepetitionIsOneBeforeTheLeaseIsLookedAt) {
  Site there(cia402_model());
  const Incoming command{.topic = "pump1/frequency_command/set", .payload = R"({"value":30.0,"id":"a1"})"};
  there.site.receive({.topic = kRoot + command.topic, .payload = command.payload});
  there.site.run(10100ms);
  there.lease_to_modbus();
  EXPECT_EQ(there.code(command), "duplicate");
}

TEST(CommandOrder, WithoutWaitingForAnswersCommandsArriveInOrder) {
  Site there(cia402_model());
  for (const char* word : {"6", "7", "15"}) {
    there.site.broker().events->on_message({.topic = kRoot + "pump1/control_command/set",
                                            .payload = std::string(R"({"value":)") + word + R"(,"id":"start"})",
                                            .received = canopen::Clock::now()});
  }
  there.site.run(300ms);
  EXPECT_EQ(there.words(), (std::vector<canopen::Raw>{6, 7, 15}));
  EXPECT_EQ(there.site.broker().on(kRoot + "result").size(), 3U);
}

TEST(CommandOrder, AFaultResetIsNoStopAndWaitsItsTurn) {
  Site there(cia402_model());
  for (const char* payload : {"15", "128"}) {
    there.site.broker().events->on_message(
        {.topic = kRoot + "pump1/control_command/set", .payload = payload, .received = canopen::Clock::now()});
  }
  there.site.run(300ms);
  EXPECT_EQ(there.words(), (std::vector<canopen::Raw>{15, 128})) << "nothing gave way to it";
  const Incoming reset{.topic = "pump1/control_command/set", .payload = R"({"value":128,"id":"r1"})"};
  EXPECT_NE(there.code(reset), "duplicate");
  EXPECT_EQ(there.code(reset), "duplicate");
}

TEST(CommandOrder, AStopIsOneWhateverStandsBesideIt) {
  Site there(cia402_model());
  for (const char* beside : {R"("frequency_command":"fast")", R"("output_frequency":1)", R"("speed":1)"}) {
    there.site.puppet().written.clear();
    there.site.broker().forget();
    there.site.command("pump1/set", std::string(R"({"control_command":6,"id":"s1",)") + beside + "}");
    there.site.run(100ms);
    const std::string answer = there.site.last_answer();
    EXPECT_NE(answer.find(R"("ok":false)"), std::string::npos) << answer;
    EXPECT_NE(answer.find("the stop beside it was carried out"), std::string::npos) << answer;
    EXPECT_EQ(there.words(), std::vector<canopen::Raw>{6}) << beside;
  }
}

TEST(CommandOrder, StopsAreKnownBeforeTheirTurnComes) {
  Site there(cia402_model());
  const auto is_stop = [](Site& site, Incoming incoming) {
    incoming.topic = kRoot + incoming.topic;
    return site.site.broker().events->is_stop(incoming);
  };
  const std::vector<Incoming> stops = {
      {.topic = "stop", .payload = "1"},
      {.topic = "pump1/control_command/set", .payload = "6"},
      {.topic = "pump1/control_command/set", .payload = R"({"value":0,"id":"s"})"},
      {.topic = "pump1/set", .payload = R"({"control_command":6,"speed":1})"},
      {.topic = "pump1/sdo/request", .payload = R"({"op":"write","object":"0x2000:01","type":"u16","value":6})"},
  };
  for (Incoming stop : stops) {
    EXPECT_TRUE(is_stop(there, stop)) << stop.topic << " " << stop.payload;
    stop.retained = true;
    EXPECT_FALSE(is_stop(there, stop)) << stop.topic << " " << stop.payload;
  }
  const std::vector<Incoming> others = {
      {.topic = "stop", .payload = ""},
      {.topic = "pump1/control_command/set", .payload = "15"},
      {.topic = "pump1/control_command/set", .payload = "128"},
      {.topic = "pump1/control_command/set", .payload = "halt"},
      {.topic = "pump1/set", .payload = R"({"frequency_command":6})"},
      {.topic = "pump1/nmt/set", .payload = "stop"},
      {.topic = "pump1/control/alive", .payload = "6"},
      {.topic = "pump1/alarm/emcy", .payload = "6"},
      {.topic = "pump9/control_command/set", .payload = "6"},
      {.topic = "pump1/sdo/request", .payload = R"({"op":"read","object":"0x2000:01","type":"u16"})"},
  };
  for (const Incoming& other : others) {
    EXPECT_FALSE(is_stop(there, other)) << other.topic << " " << other.payload;
  }
  Site forbidden(without_mqtt());
  EXPECT_FALSE(is_stop(forbidden, stops[1])) << "it will be refused";
}

TEST(CommandOrder, WhatTheBridgeRefusesItselfStandsInTheJournalAsItIsTold) {
  for (const bool leased : {false, true}) {
    Ids journal;
    Site there(cia402_model());
    if (leased) {
      there.lease_to_modbus();
    }
    there.site.plant().drive(0).set_journal(&journal);
    std::vector<std::string> told;
    for (Incoming mistake : kMistakes) {
      told.push_back(there.code(mistake));
      mistake.retained = true;
      told.push_back(there.code(mistake));
    }
    const Incoming closed_topic{
        .topic = "pump1/frequency_command/set", .payload = "30.0", .response_topic = kRoot + "pump1/set"};
    told.push_back(there.code(closed_topic));
    EXPECT_EQ(journal.codes, told);
    EXPECT_EQ(told[0], leased ? "lease" : "type");
    EXPECT_EQ(told.back(), "forbidden");
  }
}

TEST(CommandOrder, ARepetitionStandsInTheJournal) {
  Ids journal;
  Site there(cia402_model());
  there.site.plant().drive(0).set_journal(&journal);
  const Incoming command{.topic = "pump1/frequency_command/set", .payload = R"({"value":30.0,"id":"a1"})"};
  there.code(command);
  EXPECT_EQ(there.code(command), "duplicate");
  EXPECT_EQ(journal.codes, (std::vector<std::string>{"ok", "duplicate"}));
  EXPECT_EQ(journal.ids, (std::vector<std::string>{"a1", "a1"}));
}

TEST(CommandOrder, WhatNamesNoDriveOrReadsIsNoLineOfTheJournal) {
  Ids journal;
  Site there(cia402_model());
  there.site.plant().drive(0).set_journal(&journal);
  EXPECT_EQ(there.code({.topic = "pump9/frequency_command/set", .payload = "30.0"}), "unknown");
  EXPECT_EQ(there.code({.topic = "pump1/sdo/request", .payload = R"({"op":"read","object":"here"})"}), "type");
  EXPECT_EQ(journal.codes, std::vector<std::string>{});
}

TEST(CommandOrder, AStopForAllThatIsRefusedIsALineOfEachDrive) {
  Ids journal;
  Site there(cia402_model());
  there.site.plant().drive(0).set_journal(&journal);
  EXPECT_EQ(there.code({.topic = "stop", .payload = "1", .retained = true}), "retained");
  EXPECT_EQ(there.code({.topic = "stop", .payload = "1", .expiry = 0}), "expired");
  EXPECT_EQ(journal.codes, (std::vector<std::string>{"retained", "expired"}));
}

TEST(CommandOrder, TheIdOfTheClientIsThatOfTheCommand) {
  Ids journal;
  Site there(cia402_model());
  there.site.plant().drive(0).set_journal(&journal);
  there.site.receive({.topic = kRoot + "pump1/frequency_command/set", .payload = R"({"value":30.0,"id":"a1"})"});
  there.site.receive({.topic = kRoot + "pump1/frequency_command/set", .payload = R"({"value":30.0,"id":17})"});
  EXPECT_EQ(journal.ids, (std::vector<std::string>{"a1", "17"}));
  EXPECT_NE(there.site.last_answer().find(R"("id":17)"), std::string::npos);
  EXPECT_NE(there.site.last_answer().find(R"("unchanged":true)"), std::string::npos) << there.site.last_answer();
}

}  // namespace
}  // namespace mqtt
