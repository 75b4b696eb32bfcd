// The real program as a process: exit codes, signals, and what it tells the service manager. It has a bus inside of
// itself, where nobody else is.

#include "tests/unit/daemon/program.h"

#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <bit>
#include <csignal>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/daemon/notify_socket.h"

namespace gateway {
namespace {

using test::NotifySocket;
using test::Program;
using test::TemporaryFile;
using testing::HasSubstr;
using Words = std::vector<std::string>;

constexpr int kWrongUsage = 2;
constexpr int kWrongConfiguration = 78;

const std::string kSite =
    "[gateway]\nname = \"line3\"\ncontrol = \"\"\nstate_dir = \"/nowhere/state\"\n[[bus]]\nname = \"can0\"\n"
    "interface = \"virtual\"\n"
    "[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"veichi-ac310\"\n";

Words with(const TemporaryFile& file, const std::string& command) {
  return {"--config", file.path(), "--profile-dir", GATEWAY_SOURCE_DIR "/config/profiles", command};
}

TEST(ExitCode, OfWrongUsageIs2) {
  for (const Words& words :
       {Words{}, Words{"fly"}, Words{"check", "--fast"}, Words{"check", "--control", "/nowhere/control"},
        Words{"map", "--format", "xml"}, Words{"simulate", "--interface", "vcan0", "--drive", "veichi-ac310"},
        Words{"simulate", "--interface", "vcan0", "--drive", "no-such-kind:5"}, Words{"simulate", "--tpdo", "half"},
        Words{"simulate", "--tpdo", "65536ms"}}) {
    Program program(words);
    EXPECT_EQ(program.exit_code(), kWrongUsage) << testing::PrintToString(words) << program.output();
    EXPECT_NE(program.output(), "") << testing::PrintToString(words) << " says nothing";
  }
}

TEST(ExitCode, OfAProfileDirectoryThatIsNotThereIs2) {
  const TemporaryFile site(kSite);
  for (const std::string& nowhere : {std::string("/nowhere/profiles"), site.path()}) {
    Program program({"--config", site.path(), "--profile-dir", nowhere, "check"});
    EXPECT_EQ(program.exit_code(), kWrongUsage) << program.output();
    EXPECT_THAT(program.output(), HasSubstr(nowhere));
  }
}

TEST(ExitCode, OfAWrongConfigurationIs78) {
  const TemporaryFile wrong(kSite + "hearbeat = 5\n");
  for (const std::string command : {"check", "map", "run", "simulate", "demo"}) {
    Program program(with(wrong, command));
    EXPECT_EQ(program.exit_code(), kWrongConfiguration) << command << ": " << program.output();
    EXPECT_THAT(program.output(), HasSubstr("unknown key \"hearbeat\"")) << command;
  }
}

TEST(ExitCode, OfWhatWasDoneIs0) {
  const TemporaryFile site(kSite);
  for (const Words& words : {Words{"--version"}, Words{"--help"}, with(site, "check"), with(site, "map")}) {
    Program program(words);
    EXPECT_EQ(program.exit_code(), 0) << testing::PrintToString(words) << program.output();
  }
}

TEST(ExitCode, OfACheckOfDrivesWithoutAGatewayIs1) {
  const TemporaryFile site(kSite);
  Words words = with(site, "check");
  words.insert(words.end(), {"--live", "--control", "/nowhere/control"});
  Program program(words);
  EXPECT_EQ(program.exit_code(), 1) << program.output();
  EXPECT_THAT(
      program.output(),
      testing::AllOf(HasSubstr("cannot reach the gateway at /nowhere/control: "),
                     HasSubstr("start it: `systemctl start canopen-gateway`, or `canopen-gateway run --config " +
                               site.path() + "`"),
                     testing::Not(HasSubstr("ok: "))));
}

TEST(ExitCode, OfACheckOfDrivesWithAWrongConfigurationIs78) {
  const TemporaryFile wrong(kSite + "hearbeat = 5\n");
  Words words = with(wrong, "check");
  words.emplace_back("--live");
  Program program(words);
  EXPECT_EQ(program.exit_code(), kWrongConfiguration) << program.output();
}

/// A port of loopback on which somebody else listens.
class TakenPort {
 public:
  TakenPort() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address_;
    auto* const any = std::bit_cast<sockaddr*>(&address_);
    EXPECT_EQ(::bind(socket_.get(), any, size), 0);
    EXPECT_EQ(::listen(socket_.get(), 1), 0);
    EXPECT_EQ(::getsockname(socket_.get(), any, &size), 0);
  }
  [[nodiscard]] int number() const { return ntohs(address_.sin_port); }

 private:
  test::Descriptor socket_;
  sockaddr_in address_{};
};

class Running : public testing::Test {
 protected:
  NotifySocket manager_;
  TemporaryFile site_{kSite};
  Program program_{
      with(site_, "run"), {"NOTIFY_SOCKET=" + manager_.name(), "WATCHDOG_USEC=300000"}, Program::Output::journal};
};

class RunningUntilASignal : public Running, public testing::WithParamInterface<int> {};

TEST_P(RunningUntilASignal, TellsTheServiceManagerFromItsStartToItsEnd) {
  ASSERT_TRUE(program_.says("<6>canopen-gateway ")) << program_.output();
  EXPECT_EQ(manager_.next(), "READY=1");
  EXPECT_EQ(manager_.next(), "WATCHDOG=1");
  EXPECT_EQ(manager_.next(), "STATUS=0 of 1 drives online");
  EXPECT_EQ(manager_.next(), "WATCHDOG=1");
  program_.signal(GetParam());
  std::optional<std::string> last = manager_.next();
  while (last == "WATCHDOG=1") {
    last = manager_.next();
  }
  EXPECT_EQ(last, "STOPPING=1");
  EXPECT_EQ(program_.exit_code(), 0) << program_.output();
  EXPECT_THAT(program_.output(), HasSubstr("<6>stopped; 0 log messages were dropped"));
  EXPECT_THAT(manager_.heard(), testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(EndedBy, RunningUntilASignal, testing::Values(SIGTERM, SIGINT));

TEST(Run, StartsWhereAnAddressToListenOnIsMissingOrTaken) {
  const TakenPort taken;
  const std::string there = "127.0.0.1:" + std::to_string(taken.number());
  const TemporaryFile site(kSite + "[modbus]\nlisten = [\"192.0.2.1:1502\", \"" + there + "\"]\n");  // RFC 5737
  Program program(with(site, "run"));
  EXPECT_TRUE(program.says("192.0.2.1:1502: this machine does not have the address")) << program.output();
  EXPECT_TRUE(program.says(there + ": cannot listen: ")) << program.output();
  EXPECT_TRUE(program.says(" serves ")) << program.output();
  program.signal(SIGTERM);
  EXPECT_EQ(program.exit_code(), 0) << program.output();
}

TEST_F(Running, ReloadsAndTellsTheManager) {
  ASSERT_TRUE(program_.says(" serves ")) << program_.output();
  for (int i = 0; i < 2; ++i) {
    (void)manager_.heard();
    program_.signal(SIGHUP);
    ASSERT_TRUE(program_.says("<6>reload: done, 1 bus")) << program_.output();
    std::string told;
    while (told != "READY=1") {
      const std::optional<std::string> next = manager_.next();
      ASSERT_TRUE(next.has_value());
      EXPECT_TRUE(told.empty() || next->starts_with("READY=1") || next->starts_with("WATCHDOG=1")) << *next;
      told = next->starts_with("RELOADING=1\nMONOTONIC_USEC=") || !told.empty() ? *next : told;
    }
  }
  program_.signal(SIGTERM);
  EXPECT_EQ(program_.exit_code(), 0) << program_.output();
}

}  // namespace
}  // namespace gateway
