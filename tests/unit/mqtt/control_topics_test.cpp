// `control`, `control/alive` and `stop`: who keeps a drive, who is still there, and how all are stopped.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "tests/support/spawn.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::PlantSite;

constexpr canopen::ObjectAddress kControlObject{0x2000, 1};

/// 5 and 6 stop the drive.
config::Drive stoppable(config::Drive drive) {
  drive.node.motor.control = kControlObject;
  drive.node.motor.stops = {{.equals = 5}, {.equals = 6}};
  return drive;
}

config::Model stoppable_model() {
  config::Model model = PlantSite::bridge_model();
  model.drives[0] = stoppable(model.drives[0]);
  return model;
}

config::Drive another(const config::Drive& like, std::string name, std::uint8_t node) {
  config::Drive drive = like;
  drive.name = std::move(name);
  drive.unit = node;
  drive.node.node = node;
  drive.node.tpdos[0].cob_id = 0x180U + node;
  drive.node.rpdos[0].cob_id = 0x200U + node;
  return drive;
}

class ControlTopics : public testing::Test {
 protected:
  /// The drive is there and takes commands, `change` made to its model.
  template <class Change>
  void begin(Change change) {
    config::Model model = stoppable_model();
    change(model);
    site_ = std::make_unique<PlantSite>(std::move(model));
    site_->bring_up_drive();
    site_->connect();
    site_->broker().forget();
  }
  void run_motor() {
    site_->command("pump1/set", R"({"frequency_command":30.0,"control_command":1})");
    ASSERT_TRUE(site_->last_answer().starts_with(R"({"ok":true,"topic":"canopen/line3/pump1/set","id":")"))
        << site_->last_answer();
    site_->send_values(0x0001, 3000, 4);
    site_->broker().forget();
  }
  void alive(const std::string& payload, bool retained = false) {
    site_->receive({.topic = "canopen/line3/pump1/control/alive", .payload = payload, .retained = retained});
  }
  [[nodiscard]] bool timed_out() const {
    return site_->retained("pump1/control").find(R"("timeout":true)") != std::string::npos;
  }
  /// How often the drive was told to stop, by SDO or RPDO.
  [[nodiscard]] std::ptrdiff_t stops() const {
    const auto& written = site_->puppet().written;
    const auto& rpdos = site_->puppet().rpdos;
    return std::ranges::count_if(written,
                                 [](const canopen::ObjectValue& value) {
                                   return value.object == kControlObject && (value.raw == 5 || value.raw == 6);
                                 }) +
           std::ranges::count_if(rpdos, [](const canopen::Frame& frame) { return frame.data[0] == 5; });
  }

  std::unique_ptr<PlantSite> site_;
};

TEST_F(ControlTopics, ShowsTheHolderOfTheLeaseUntilItsEnd) {
  begin([](config::Model& model) { model.drives[0].commands.lease = 10s; });
  EXPECT_EQ(site_->retained("pump1/control"), R"({"holder":null,"since":null,"timeout":false})");
  site_->command("pump1/frequency_command/set", "30");
  const std::string held = site_->retained("pump1/control");
  EXPECT_TRUE(held.starts_with(R"({"holder":"mqtt","since":"2026-01-02T03:04:)")) << held;
  EXPECT_TRUE(held.ends_with(R"(Z","timeout":false})")) << held;
  site_->run(9s);
  EXPECT_EQ(site_->retained("pump1/control"), held);
  site_->run(1100ms);
  EXPECT_EQ(site_->retained("pump1/control"), R"({"holder":null,"since":null,"timeout":false})");
}

TEST_F(ControlTopics, NamesTheAddressOfAModbusClient) {
  begin([](config::Model& model) {
    model.drives[0].commands.lease = 10s;
    model.drives[0].commands.writers.modbus = true;
  });
  const auto written = support::spawn(
      site_->loop().executor(),
      site_->plant().drive(0).write({.writer = {.way = process::Writer::Way::modbus, .address = "192.0.2.7"}},
                                    {{test::kFrequencyCommand, 20.0}}));
  site_->run(100ms);
  ASSERT_TRUE(written.done());
  EXPECT_TRUE(site_->retained("pump1/control").starts_with(R"({"holder":"modbus 192.0.2.7","since":")"))
      << site_->retained("pump1/control");
  site_->command("pump1/frequency_command/set", "30");
  EXPECT_NE(site_->last_answer().find(R"("code":"lease")"), std::string::npos) << site_->last_answer();
  EXPECT_NE(site_->last_answer().find("modbus 192.0.2.7 holds the lease"), std::string::npos) << site_->last_answer();
}

TEST_F(ControlTopics, ASignOfLifeKeepsTheTimeoutAway) {
  begin([](config::Model& model) { model.drives[0].commands.timeout = 2s; });
  run_motor();
  for (int i = 0; i < 5; ++i) {
    site_->run(1500ms);
    alive(i % 2 == 0 ? "here" : "");
  }
  EXPECT_FALSE(timed_out());
  site_->run(2200ms);
  EXPECT_TRUE(timed_out());
  EXPECT_NE(site_->retained("pump1/alarm/control").find(R"("active":true)"), std::string::npos);
  alive("again");
  EXPECT_TRUE(timed_out()) << "only a command ends it";
  run_motor();
  EXPECT_FALSE(timed_out());
}

TEST_F(ControlTopics, ARetainedSignOfLifeIsNoneAndIsEmptied) {
  begin([](config::Model& model) { model.drives[0].commands.timeout = 2s; });
  run_motor();
  site_->run(1500ms);
  alive("here", true);
  EXPECT_EQ(site_->retained("pump1/control/alive"), "");
  site_->broker().forget();
  alive("", true);
  EXPECT_TRUE(site_->broker().on("canopen/line3/pump1/control/alive").empty()) << "not again and again";
  site_->run(700ms);
  EXPECT_TRUE(timed_out());
}

TEST_F(ControlTopics, ASignOfLifeOfNobodyIsIgnored) {
  begin([](config::Model&) {});
  site_->command("pump9/control/alive", "here");
  EXPECT_TRUE(site_->broker().on("canopen/line3/result").empty());
}

TEST_F(ControlTopics, StopForAllStopsAndIsAnswered) {
  begin([](config::Model&) {});
  run_motor();
  site_->command("stop", "now");
  EXPECT_EQ(site_->last_answer(), R"({"ok":true,"topic":"canopen/line3/stop"})");
  EXPECT_EQ(stops(), 1);
}

TEST_F(ControlTopics, StopForAllNamesThoseThatDidNotConfirmOrHaveNoStopValue) {
  begin([](config::Model& model) {
    model.drives.push_back(another(model.drives[0], "away1", 6));
    config::Drive unknown = another(PlantSite::bridge_model().drives[0], "plain1", 7);
    model.drives.push_back(unknown);
    model.drives.push_back(another(model.drives[0], "other1", 8));
    model.drives.back().commands.writers.mqtt = false;
    model.drives.push_back(another(model.drives[0], "off1", 9));
    model.drives.back().enabled = false;
  });
  site_->command("stop", R"({"id":"s1"})");
  EXPECT_EQ(stops(), 1) << "who is there is not kept waiting";
  site_->run(1s);
  const std::string answer = site_->last_answer();
  EXPECT_TRUE(answer.starts_with(R"({"ok":false,"code":"offline","error":"not confirmed: away1 ()")) << answer;
  EXPECT_NE(answer.find("; plain1 ("), std::string::npos) << answer;
  EXPECT_EQ(answer.find("pump1"), std::string::npos) << answer;
  EXPECT_EQ(answer.find("other1"), std::string::npos) << answer;
  EXPECT_EQ(answer.find("off1"), std::string::npos) << answer;
  EXPECT_TRUE(answer.ends_with(R"("topic":"canopen/line3/stop","id":"s1"})")) << answer;
}

TEST_F(ControlTopics, StopForAllWhereNobodyTakesCommandsIsForbidden) {
  begin([](config::Model& model) { model.drives[0].commands.writers.mqtt = false; });
  site_->command("stop", "1");
  EXPECT_NE(site_->last_answer().find(R"("code":"forbidden")"), std::string::npos) << site_->last_answer();
  EXPECT_EQ(stops(), 0);
}

TEST_F(ControlTopics, StopForAllIsNeverADuplicate) {
  begin([](config::Model&) {});
  for (int i = 0; i < 3; ++i) {
    site_->command("stop", R"({"id":"s1"})");
    EXPECT_EQ(site_->last_answer(), R"({"ok":true,"topic":"canopen/line3/stop","id":"s1"})");
  }
  EXPECT_EQ(stops(), 3);
}

TEST_F(ControlTopics, StopForAllIsAnsweredWhereItWasAsked) {
  begin([](config::Model&) {});
  site_->receive(
      {.topic = "canopen/line3/stop", .payload = "1", .response_topic = "panel/answers", .correlation = "c7"});
  ASSERT_EQ(site_->broker().on("panel/answers").size(), 1U);
  EXPECT_EQ(site_->broker().published.back().correlation, "c7");
  site_->broker().forget();
  site_->receive({.topic = "canopen/line3/stop", .payload = "1", .response_topic = "canopen/line4/stop"});
  EXPECT_EQ(site_->last_answer(), R"({"ok":true,"topic":"canopen/line3/stop"})") << "not lost for its answer's sake";
  EXPECT_EQ(stops(), 2);
}

TEST_F(ControlTopics, ARetainedOrEmptyStopForAllIsNone) {
  begin([](config::Model&) {});
  site_->receive({.topic = "canopen/line3/stop", .payload = "1", .retained = true});
  EXPECT_NE(site_->last_answer().find(R"("code":"retained")"), std::string::npos) << site_->last_answer();
  EXPECT_EQ(site_->retained("stop"), "");
  site_->broker().forget();
  site_->command("stop", "");
  EXPECT_EQ(site_->last_answer(), "none") << "our own emptying comes back to us";
  EXPECT_EQ(stops(), 0);
}

TEST_F(ControlTopics, TheSameStopAgainIsAnotherStop) {
  begin([](config::Model&) {});
  const std::string payload = R"({"value":5,"id":"a1"})";
  const std::string unchanged = R"(,"unchanged":true})";
  for (const std::string& end : {std::string("}"), unchanged}) {
    site_->broker().forget();
    site_->command("pump1/control_command/set", payload);
    EXPECT_EQ(site_->last_answer(), R"({"ok":true,"topic":"canopen/line3/pump1/control_command/set","id":"a1")" + end);
  }
  const std::string raw = R"({"id":"7","op":"write","object":"0x2000:01","type":"u16","value":6})";
  for (const std::string& end : {std::string("}"), unchanged}) {
    site_->broker().forget();
    site_->command("pump1/sdo/request", raw);
    EXPECT_EQ(site_->last_answer("canopen/line3/pump1/sdo/response"), R"({"id":"7","ok":true)" + end);
  }
  EXPECT_EQ(stops(), 4);
}

TEST_F(ControlTopics, NoNumberOfCommandsUnderWayRefusesAStop) {
  begin([](config::Model&) {});
  site_->puppet().mute = true;
  for (std::size_t i = 0; i <= Requests::kMaxCommands; ++i) {
    site_->command("pump1/control_command/set", "1");  // none of these gives way to the next
  }
  EXPECT_NE(site_->last_answer().find("too many commands under way"), std::string::npos) << site_->last_answer();
  site_->puppet().mute = false;
  site_->broker().forget();
  site_->command("pump1/control_command/set", R"({"value":5,"id":"stop"})");
  site_->run(200ms);
  const auto answers = site_->broker().on("canopen/line3/result");
  EXPECT_EQ(std::ranges::count(answers, R"({"ok":true,"topic":"canopen/line3/pump1/control_command/set","id":"stop"})"),
            1);
  EXPECT_EQ(std::ranges::count_if(
                answers, [](const std::string& answer) { return answer.find("superseded") != std::string::npos; }),
            static_cast<std::ptrdiff_t>(Requests::kMaxCommands) - 1)
      << "all but the one under way";
  EXPECT_GE(stops(), 1);
  EXPECT_LE(stops(), 2) << "by RPDO at once and by SDO behind the write under way";
}

}  // namespace
}  // namespace mqtt
