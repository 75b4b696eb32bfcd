#include "bridges/mqtt/requests.h"

#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::PlantSite;

class MqttRequests : public testing::Test {
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
  std::string ask_sdo(const std::string& payload) {
    site_.broker().forget();
    site_.command("pump1/sdo/request", payload);
    return site_.last_answer("canopen/line3/pump1/sdo/response");
  }
  static std::string code_of(const std::string& answer) {
    const std::size_t start = answer.find("\"code\":\"");
    return start == std::string::npos ? answer : answer.substr(start + 8, answer.find('"', start + 8) - start - 8);
  }
  [[nodiscard]] std::size_t commands_sent() { return site_.puppet().rpdos.size() + site_.puppet().written.size(); }

  PlantSite site_;
};

TEST_F(MqttRequests, ASetIsCarriedOutAndAnswered) {
  const std::string answer = ask("pump1/frequency_command/set", "30.00");
  const std::regex with_made_id(
      R"re(\{"ok":true,"topic":"canopen/line3/pump1/frequency_command/set","id":"[0-9A-F]{8}-1"\})re");
  EXPECT_TRUE(std::regex_match(answer, with_made_id)) << answer;
  ASSERT_EQ(site_.puppet().written.size(), 1U) << "one field alone goes by SDO";
  EXPECT_EQ(site_.puppet().written[0].raw, 3000U);
}

TEST_F(MqttRequests, SeveralAtOnceGoInOnePdo) {
  EXPECT_EQ(ask("pump1/set", R"({"frequency_command":30.0,"control_command":1,"id":"a2"})"),
            R"({"ok":true,"topic":"canopen/line3/pump1/set","id":"a2"})");
  EXPECT_EQ(site_.puppet().rpdos.size(), 1U);
}

TEST_F(MqttRequests, RefusalsNameTheirCodeAndChangeNothing) {
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", "50.01")), "range");
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", "fast")), "type");
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", "{\"value\":")), "type");
  EXPECT_EQ(code_of(ask("pump1/output_frequency/set", "1")), "read-only");
  EXPECT_EQ(code_of(ask("pump1/speed/set", "1")), "unknown");
  EXPECT_EQ(code_of(ask("pump9/speed/set", "1")), "unknown");
  EXPECT_EQ(code_of(ask("pump1/set", R"({"speed":1})")), "unknown");
  EXPECT_EQ(code_of(ask("pump1/set", "30")), "type");
  EXPECT_EQ(code_of(ask("pump1/nmt/set", "run")), "unknown");
  EXPECT_EQ(commands_sent(), 0U);
}

TEST_F(MqttRequests, OneThatWasOneTooManyMayComeAgain) {
  const auto command = [](std::size_t i) {
    return R"({"control_command":)" + std::to_string(i % 50) + R"(,"id":"n)" + std::to_string(i) + "\"}";
  };
  site_.puppet().mute = true;
  site_.broker().forget();
  for (std::size_t i = 0; i <= Requests::kMaxCommands; ++i) {
    site_.command("pump1/set", command(i));
  }
  EXPECT_NE(site_.last_answer().find("too many commands under way"), std::string::npos) << site_.last_answer();
  site_.loop().advance(900ms);
  site_.puppet().mute = false;
  EXPECT_NE(code_of(ask("pump1/set", command(Requests::kMaxCommands))), "duplicate");
  EXPECT_EQ(code_of(ask("pump1/set", command(0))), "duplicate");
}

TEST_F(MqttRequests, AnAbortIsNamed) {
  site_.puppet().refuse_writes[{0x2031, 0}] = 0x08000022;
  const std::string answer = ask("pump1/mode/set", "torque");
  EXPECT_EQ(code_of(answer), "refused");
  EXPECT_NE(answer.find(R"("abort":"0x08000022")"), std::string::npos) << answer;
}

TEST_F(MqttRequests, ADriveThatIsAwayIsOffline) {
  site_.puppet().mute = true;
  site_.loop().advance(2s, 10ms);
  EXPECT_EQ(code_of(ask("pump1/frequency_command/set", "30")), "offline");
}

TEST_F(MqttRequests, AWriterThatIsNotAllowedIsForbidden) {
  config::Model model = PlantSite::bridge_model();
  model.drives[0].commands.writers.mqtt = false;
  PlantSite site(std::move(model));
  site.bring_up_drive();
  site.connect();
  site.command("pump1/frequency_command/set", "30");
  EXPECT_EQ(code_of(site.last_answer()), "forbidden");
}

TEST_F(MqttRequests, AnswersGoToTheResponseTopicWithItsCorrelationData) {
  site_.receive({.topic = "canopen/line3/pump1/frequency_command/set",
                 .payload = "30",
                 .response_topic = "answers/1",
                 .correlation = std::string("\0\x01", 2)});
  ASSERT_EQ(site_.broker().on("answers/1").size(), 1U);
  EXPECT_EQ(site_.broker().published.back().correlation, std::string("\0\x01", 2));
  EXPECT_TRUE(site_.broker().on("canopen/line3/result").empty());
}

TEST_F(MqttRequests, AResponseTopicInACommandTreeIsRefused) {
  site_.receive({.topic = "canopen/line3/pump1/frequency_command/set",
                 .payload = "30",
                 .response_topic = "canopen/line3/pump1/frequency_command/set"});
  EXPECT_EQ(code_of(site_.last_answer()), "forbidden");
  EXPECT_EQ(commands_sent(), 0U);
  EXPECT_TRUE(site_.broker().on("canopen/line3/pump1/frequency_command/set").empty());
}

TEST_F(MqttRequests, AResponseTopicInAnotherGatewaysTreeIsRefused) {
  site_.receive({.topic = "canopen/line3/pump1/frequency_command/set",
                 .payload = "30",
                 .response_topic = "canopen/line4/pump1/status"});
  EXPECT_EQ(code_of(site_.last_answer()), "forbidden");
  EXPECT_EQ(commands_sent(), 0U);
  EXPECT_TRUE(site_.broker().on("canopen/line4/pump1/status").empty());
}

TEST_F(MqttRequests, ARetainedCommandIsNeverCarriedOutAndItsTopicEmptied) {
  site_.receive({.topic = "canopen/line3/pump1/frequency_command/set", .payload = "30", .retained = true});
  EXPECT_EQ(code_of(site_.last_answer()), "retained");
  EXPECT_EQ(commands_sent(), 0U);
  const auto& published = site_.broker().published;
  EXPECT_NE(std::find(published.begin(), published.end(),
                      Message{.topic = "canopen/line3/pump1/frequency_command/set", .payload = "", .retained = true}),
            published.end());
  EXPECT_EQ(ask("pump1/frequency_command/set", ""), "none") << "our own emptying comes back to us";
}

TEST_F(MqttRequests, AnExpiredCommandIsNotCarriedOut) {
  site_.receive({.topic = "canopen/line3/pump1/frequency_command/set", .payload = "30", .expiry = 0});
  EXPECT_EQ(code_of(site_.last_answer()), "expired");
  Incoming late{.topic = "canopen/line3/pump1/frequency_command/set",
                .payload = "30",
                .expiry = 2,
                .received = canopen::Clock::now() - 2s};
  site_.broker().forget();
  site_.broker().events->on_message(late);
  site_.loop().settle();
  EXPECT_EQ(code_of(site_.last_answer()), "expired");
  EXPECT_EQ(commands_sent(), 0U);
  site_.broker().forget();
  site_.receive({.topic = "canopen/line3/pump1/frequency_command/set", .payload = "30", .expiry = 2});
  EXPECT_EQ(commands_sent(), 1U);
}

TEST_F(MqttRequests, TheSameCommandAgainIsADuplicate) {
  const std::string payload = R"({"value":30.0,"id":"a1"})";
  EXPECT_NE(ask("pump1/frequency_command/set", payload).find("\"ok\":true"), std::string::npos);
  const std::string again = ask("pump1/frequency_command/set", payload);
  EXPECT_EQ(code_of(again), "duplicate");
  EXPECT_NE(again.find(R"("id":"a1")"), std::string::npos);
  EXPECT_EQ(commands_sent(), 1U);
  site_.run(60s);
  EXPECT_NE(ask("pump1/frequency_command/set", payload).find("\"ok\":true"), std::string::npos);
}

TEST_F(MqttRequests, WithoutAnIdEveryCommandIsCarriedOut) {
  for (const char* payload : {"30", "40", "30"}) {
    EXPECT_NE(ask("pump1/frequency_command/set", payload).find("\"ok\":true"), std::string::npos);
  }
  EXPECT_EQ(commands_sent(), 3U);
}

TEST_F(MqttRequests, SdoReadsAndWrites) {
  EXPECT_EQ(ask_sdo(R"({"id":"7","op":"read","object":"0x2002:03","type":"u16"})"),
            R"({"id":"7","ok":true,"value":4660})");
  EXPECT_EQ(ask_sdo(R"({"id":"7","op":"read","object":"0x2002:03","type":"u16"})"),
            R"({"id":"7","ok":true,"value":4660})")
      << "reads are never duplicates";
  const std::string absent = ask_sdo(R"({"id":"8","op":"read","object":"0x5FFF:00","type":"u16"})");
  EXPECT_TRUE(absent.starts_with(R"({"id":"8","ok":false,"code":"refused","abort":"0x06020000","error":")")) << absent;
  EXPECT_EQ(code_of(ask_sdo(R"({"id":"9","op":"write","object":"0x2002:03","type":"u16","value":3})")), "forbidden")
      << "raw writes are off";
  EXPECT_EQ(ask_sdo(R"({"id":"10","op":"write","object":"0x2031:00","type":"u8","value":1})"),
            R"({"id":"10","ok":true})")
      << "an object that is a writable signal";
  EXPECT_EQ(code_of(ask_sdo(R"({"op":"read"})")), "type");
}

TEST_F(MqttRequests, SdoReadsAndWritesTextAndBytes) {
  site_.puppet().dictionary[{0x1008, 0}] = {.value = 0x00434241, .size = 4};
  EXPECT_EQ(ask_sdo(R"({"id":"1","op":"read","object":"0x1008:00","type":"string"})"),
            R"({"id":"1","ok":true,"value":"ABC"})");
  EXPECT_EQ(ask_sdo(R"({"id":"2","op":"read","object":"0x1008:00","type":"bytes"})"),
            R"({"id":"2","ok":true,"value":"41424300"})");
  EXPECT_EQ(code_of(ask_sdo(R"({"id":"3","op":"write","object":"0x2002:03","type":"bytes","value":"0300"})")),
            "forbidden")
      << "raw writes are off";
  site_.puppet().written.clear();
  EXPECT_EQ(ask_sdo(R"({"id":"4","op":"write","object":"0x2031:00","type":"bytes","value":"02"})"),
            R"({"id":"4","ok":true})")
      << "an object that is a writable signal, and as many bytes as that has";
  ASSERT_EQ(site_.puppet().written.size(), 1U);
  EXPECT_EQ(site_.puppet().written[0].raw, 2U);
  EXPECT_EQ(code_of(ask_sdo(R"({"id":"5","op":"write","object":"0x2031:00","type":"bytes","value":"0200"})")), "type");
}

TEST_F(MqttRequests, NmtCommandsAreSent) {
  EXPECT_NE(ask("pump1/nmt/set", "stop").find("\"ok\":true"), std::string::npos) << site_.last_answer();
  EXPECT_EQ(site_.puppet().nmt_commands.back(), 2);
  site_.send_values(0x0001, 0, 3);
}

TEST_F(MqttRequests, TooManyAtATimeAreRefusedAndTheOthersAnswered) {
  site_.puppet().mute = true;  // nothing is answered any more
  for (int i = 0; i < 70; ++i) {
    site_.broker().events->on_message(
        {.topic = "canopen/line3/pump1/control_command/set", .payload = "1", .received = canopen::Clock::now()});
  }
  site_.loop().settle();
  EXPECT_EQ(site_.broker().on("canopen/line3/result").size(), 6U);
  EXPECT_EQ(code_of(site_.last_answer()), "timeout");
  site_.loop().advance(1s, 10ms);
  EXPECT_EQ(site_.broker().on("canopen/line3/result").size(), 70U);
}

TEST_F(MqttRequests, ReadsWithoutAnAnswerRefuseNoCommand) {
  site_.puppet().mute = true;
  for (int i = 0; i < 70; ++i) {
    site_.broker().events->on_message({.topic = "canopen/line3/pump1/sdo/request",
                                       .payload = R"({"op":"read","object":"0x2002:03","type":"u16"})",
                                       .received = canopen::Clock::now()});
  }
  site_.loop().settle();
  const auto refused = site_.broker().on("canopen/line3/pump1/sdo/response");
  EXPECT_EQ(refused.size(), 6U);
  EXPECT_NE(refused.back().find("too many reads under way"), std::string::npos) << refused.back();
  EXPECT_EQ(ask("pump1/frequency_command/set", "30"), "none") << "it is under way";
}

TEST_F(MqttRequests, AtTheEndNoCommandIsTakenAndThoseUnderWayAreAnswered) {
  site_.puppet().mute = true;
  site_.command("pump1/mode/set", "1");
  EXPECT_EQ(site_.last_answer(), "none");
  site_.stop_bridge();
  const auto& last = site_.broker().last_words;
  const auto answer = std::find_if(last.begin(), last.end(),
                                   [](const Message& message) { return message.topic == "canopen/line3/result"; });
  const auto earlier = site_.broker().on("canopen/line3/result");
  EXPECT_TRUE(answer != last.end() || !earlier.empty());
  site_.broker().forget();
  site_.command("pump1/mode/set", "1");
  EXPECT_TRUE(site_.broker().published.empty());
}

}  // namespace
}  // namespace mqtt
