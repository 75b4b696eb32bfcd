// The commands that go through the running gateway, as processes: exit codes and what is told. The gateway's bus is
// inside of it, where no drive is.

#include <gmock/gmock.h>

#include <csignal>
#include <string>
#include <vector>

#include "daemon/options.h"
#include "daemon/temporary_directory.h"
#include "tests/unit/daemon/program.h"

namespace gateway::control {
namespace {

using gateway::test::Program;
using gateway::test::TemporaryFile;
using testing::HasSubstr;
using Words = std::vector<std::string>;

struct Told {
  int code;
  std::string text;
};

class ControlCommandLine : public testing::Test {
 protected:
  static Told run(const Words& words) {
    Program program(words);
    const int code = program.exit_code();
    return {code, program.output()};
  }
  [[nodiscard]] Words with_site(const Words& words) const {
    Words all{"--config", site_.path(), "--profile-dir", GATEWAY_SOURCE_DIR "/config/profiles"};
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }

  TemporaryDirectory directory_;
  std::string socket_ = (directory_.path() / "control").string();
  TemporaryFile site_{"[gateway]\nname = \"line3\"\ncontrol = \"" + socket_ +
                      "\"\n[[bus]]\nname = \"can0\"\ninterface = \"virtual\"\n"
                      "[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"veichi-ac310\"\n"
                      "[[drive]]\nname = \"fan1\"\nnode = 6\nprofile = \"veichi-ac310\"\n"
                      "[drive.commands]\nwriters = [\"local\"]\n"};
};

TEST_F(ControlCommandLine, WrongUsageIs2) {
  for (const Words& words :
       {Words{"set"}, Words{"set", "pump1"}, Words{"set", "pump1", "frequency_command"}, Words{"nmt", "pump1"},
        Words{"sdo"}, Words{"sdo", "read", "pump1"}, Words{"sdo", "read", "pump1", "0x2002:03", "u16", "5"},
        Words{"sdo", "write", "pump1", "0x2002:03"}, Words{"status", "pump1"}, Words{"stop", "pump1"}}) {
    const Told told = run(words);
    EXPECT_EQ(told.code, kUsage) << testing::PrintToString(words) << told.text;
    EXPECT_NE(told.text, "") << testing::PrintToString(words);
  }
}

TEST_F(ControlCommandLine, AnNmtCommandThatIsNoneIsWrongUsageWhetherAGatewayRunsOrNot) {
  for (const char* const word : {"bogus", "Start", "", "1"}) {
    const Told told = run(with_site({"nmt", "pump1", word}));
    EXPECT_EQ(told.code, kUsage) << told.text;
    EXPECT_THAT(told.text, HasSubstr("start, stop, pre-operational, reset-node or reset-communication, not \"" +
                                     std::string(word) + "\""));
  }
}

TEST_F(ControlCommandLine, WithoutAGatewayItIs1) {
  for (const Words& words :
       {Words{"status"}, Words{"status", "--watch"}, Words{"trace"}, Words{"stop"}, Words{"set", "pump1", "a=1"},
        Words{"nmt", "pump1", "start"}, Words{"sdo", "read", "pump1", "0x2002:03"}}) {
    for (const Told& told : {run(with_site(words)), [&] {
                               Words all = words;
                               all.insert(all.end(), {"--control", socket_});
                               return run(all);
                             }()}) {
      EXPECT_EQ(told.code, kFailed) << told.text;
      EXPECT_THAT(told.text, HasSubstr("cannot reach the gateway at " + socket_ + ": No such file or directory; does"));
    }
  }
}

TEST_F(ControlCommandLine, AConfigurationThatIsNamedAndWrongIs78) {
  const TemporaryFile wrong("[gateway]\nnaim = \"line3\"\n");
  const Told told = run({"--config", wrong.path(), "status"});
  EXPECT_EQ(told.code, kConfigurationError);
  EXPECT_THAT(told.text, HasSubstr("unknown key \"gateway.naim\""));
}

TEST_F(ControlCommandLine, AsksTheRunningGateway) {
  Program gateway(with_site({"run"}));
  ASSERT_TRUE(gateway.says(" serves ")) << gateway.output();

  const Told table = run(with_site({"status"}));
  EXPECT_EQ(table.code, kDone);
  EXPECT_THAT(table.text, HasSubstr("gateway line3 "));
  EXPECT_THAT(table.text, HasSubstr("\npump1  can0  5     offline"));
  EXPECT_THAT(run({"status", "--json", "--control", socket_}).text, HasSubstr("\"gateway\":\"line3\""));

  const Told forbidden = run(with_site({"set", "pump1", "frequency_command=-1.5"}));
  EXPECT_EQ(forbidden.code, kFailed);
  EXPECT_THAT(forbidden.text, HasSubstr("canopen-gateway: forbidden: "));
  EXPECT_THAT(run(with_site({"set", "fan1", "frequency_command=1.5"})).text, HasSubstr("canopen-gateway: offline: "));
  EXPECT_THAT(run(with_site({"sdo", "write", "fan1", "0x2002:03", "i16", "-5"})).text,
              HasSubstr("canopen-gateway: forbidden"))
      << "it does not take a negative number for an option";

  gateway.signal(SIGTERM);
  EXPECT_EQ(gateway.exit_code(), 0) << gateway.output();
  EXPECT_FALSE(std::filesystem::exists(socket_));
}

TEST_F(ControlCommandLine, TraceAndWatchGoOnUntilASignalOrTheGatewaysEnd) {
  Program gateway(with_site({"run"}));
  ASSERT_TRUE(gateway.says(" serves ")) << gateway.output();
  // The gateway's own heartbeat is all that is on its bus.
  Program trace(with_site({"trace", "can0", "--kind", "heartbeat"}));
  ASSERT_TRUE(trace.says(" >77F gateway    heartbeat operational\n")) << trace.output();
  Program raw(with_site({"trace", "--raw", "--id", "0x77F"}));
  ASSERT_TRUE(raw.says(") can0 77F#05\n")) << raw.output();
  Program watch(with_site({"status", "--watch"}));
  ASSERT_TRUE(watch.says("Z  gateway line3 ")) << watch.output();
  ASSERT_TRUE(watch.says("\npump1  can0  5     offline")) << watch.output();
  Program json({"status", "--watch", "--json", "--control", socket_});
  ASSERT_TRUE(json.says("{\"ts\":\"")) << json.output();
  for (Program* const interrupted : {&trace, &json}) {
    interrupted->signal(SIGINT);
    EXPECT_EQ(interrupted->exit_code(), kDone) << interrupted->output();
  }
  const Told unknown = run(with_site({"trace", "pump9"}));
  EXPECT_EQ(unknown.code, kFailed);
  EXPECT_THAT(unknown.text, HasSubstr("no drive or bus \"pump9\"; there are pump1, fan1, and the buses can0"));

  gateway.signal(SIGTERM);
  EXPECT_EQ(gateway.exit_code(), 0) << gateway.output();
  for (Program* const left : {&raw, &watch}) {
    EXPECT_EQ(left->exit_code(), kFailed);
    EXPECT_THAT(left->output(), HasSubstr("canopen-gateway: the gateway has ended\n"));
  }
}

TEST_F(ControlCommandLine, ALogIsDecodedWithoutAGateway) {
  const TemporaryFile log(
      "(1767323045.000001) vcan7 705#05\nnonsense\n(1767323045.000002) vcan7 585#4B21200285130000\n");
  const Told told = run(with_site({"trace", log.path()}));
  EXPECT_EQ(told.code, kFailed) << "one line is none of a log";
  EXPECT_THAT(told.text, HasSubstr("03:04:05.000001 can0  705 pump1      heartbeat operational\n"));
  EXPECT_THAT(told.text, HasSubstr(log.path() + ": line 2: does not begin with a time"));
  EXPECT_THAT(told.text, HasSubstr("SDO       answer: 0x2021:02 output_frequency = 49.97 Hz\n"));

  const TemporaryFile good("(1767323045.000001) vcan7 705#05\n");
  const Told raw = run(with_site({"trace", good.path(), "--raw", "pump1"}));
  EXPECT_EQ(raw.code, kDone);
  EXPECT_EQ(raw.text, "(1767323045.000001) vcan7 705#05\n");
  EXPECT_EQ(run(with_site({"trace", good.path(), "pump9"})).code, kUsage);
  EXPECT_EQ(run(with_site({"trace", good.path(), good.path()})).code, kUsage);
  EXPECT_EQ(run(with_site({"trace", "/nowhere/x.log"})).code, kFailed);
}

}  // namespace
}  // namespace gateway::control
