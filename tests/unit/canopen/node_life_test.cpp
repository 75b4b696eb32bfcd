// The life of a node where others act on it, too: what is heard ends what was begun, and nothing is written to a node
// that runs or may run.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using Bytes = support::ScriptedSlave::Bytes;

constexpr ObjectAddress kMapping{0x1A00, 2};
constexpr Raw kOtherMapping = 0x60430010;
constexpr ObjectAddress kStatusWord{0x6041, 0};

NodeSettings with_motor() {
  NodeSettings settings = bench_settings();
  settings.motor.running = kRunning;
  settings.motor.fault = MotorSign{kStatusWord, DataType::u16, 8, {8}};
  settings.motor.control = kControlWord;
  settings.motor.stops = {{0xF882, 0}, {0xF884, 0}, {0xF887, 6}};
  return settings;
}

class NodeLifeTest : public NodeCommandBench {
 protected:
  void says(std::uint8_t state) {
    slave_.set_state(state);
    slave_.send(0x705, {state});
    loop_.advance(1ms);
  }
  /// In the middle of a configuration that writes; the slave answers each request after 20 ms.
  void configure_half() {
    install(bench_settings());
    slave_.set(kMapping, DataType::u32, kOtherMapping);
    slave_.delay_answers(20ms);
    start(bench_settings());
    slave_.boot_up();
    ASSERT_TRUE(loop_.advance_until([this] { return slave_.writes().size() == 3; }, 2s));
  }
  /// Without heartbeat, TPDOs or guarding: nothing tells its state.
  void start_unknown(const NodeSettings& settings) {
    install(settings);
    slave_.set(kHeartbeatTime, DataType::u16, 0);
    slave_.set_state(5);
    start(settings);
  }
  /// As CiA 402 devices do: PDO settings only while pre-operational.
  void refuse_pdo_settings_while_operational() {
    slave_.script([this](const Bytes& request) -> std::optional<std::vector<Bytes>> {
      const bool write = (request[0] & 0xE0U) == 0x20;
      if (write && slave_.state() == 5 && request[2] >= 0x14 && request[2] < 0x1C) {
        return std::vector<Bytes>{{0x80, request[1], request[2], request[3], 0x22, 0, 0, 0x08}};
      }
      return std::nullopt;
    });
  }
  void leave_operational() {
    slave_.forget_heard();
    says(127);
    ASSERT_EQ(status().boot_result, BootResult::not_configured);
  }
};

TEST_F(NodeLifeTest, StartedBySomebodyElseItIsNotWrittenToAnyMore) {
  configure_half();
  says(5);
  const std::size_t before = slave_.writes().size();
  loop_.advance(10s, 5ms);
  EXPECT_EQ(slave_.writes().size(), before);
  EXPECT_TRUE(nmt_heard().empty());
  expect_letter(BootResult::left_alone,
                "our configuration of it was interrupted: 3 objects were written, the last 0x1A00:");
}

TEST_F(NodeLifeTest, ItsConfigurationGoesOnWhenItLeavesAgain) {
  configure_half();
  says(5);
  loop_.advance(3s, 5ms);
  ASSERT_EQ(status().boot_result, BootResult::left_alone);
  says(127);
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  EXPECT_EQ(slave_.value(kMapping), 0x60440010U);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(NodeLifeTest, WithoutAnySignErrorControlIsSetFirstAndTheHeartbeatDecides) {
  start_unknown(bench_settings());
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  loop_.advance(6s, 5ms);
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kHeartbeatTime}) << "the one write before it was known";
  EXPECT_TRUE(nmt_heard().empty());
  expect_letter(BootResult::left_alone, "0x1A00:02");
}

TEST_F(NodeLifeTest, WithoutAnySignARunningDriveAsWantedIsTakenOver) {
  start_unknown(bench_settings());
  ASSERT_TRUE(wait_online(4s)) << status().boot_text;
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kHeartbeatTime});
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::taken_over});
}

TEST_F(NodeLifeTest, WhereLifeGuardingIsSetNoHeartbeatIsSwitchedOnAndNoRequestStartsIt) {
  NodeSettings settings = with_motor();
  settings.error_control.has_guarding = true;
  start_unknown(settings);
  slave_.answer_guarding(true);
  slave_.set({0x100C, 0}, DataType::u16, 500);
  slave_.set({0x100D, 0}, DataType::u8, 3);
  slave_.set(kStatusWord, DataType::u16, 0x0627);
  loop_.advance(70s, 10ms);
  EXPECT_TRUE(slave_.heard_on(0x705).empty()) << "the first request starts life guarding (CiA 301 7.2.8.2.2.1)";
  EXPECT_TRUE(slave_.writes().empty());
  expect_letter(BootResult::left_alone, "its motor runs");
}

TEST_F(NodeLifeTest, WhereNothingWillEverTellTheMotorIsReadBeforeTheFirstWrite) {
  NodeSettings settings = with_motor();
  settings.error_control.heartbeat = Duration::zero();
  start_unknown(settings);
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  loop_.advance(5s, 5ms);
  EXPECT_TRUE(slave_.writes().empty());
  expect_letter(BootResult::left_alone, "cannot be read");
  slave_.set(kStatusWord, DataType::u16, 0x0627);
  loop_.advance(61s, 10ms);
  EXPECT_TRUE(slave_.writes().empty());
  expect_letter(BootResult::left_alone, "its motor runs");
  slave_.set(kStatusWord, DataType::u16, 0x0650);
  EXPECT_TRUE(wait_online(70s)) << "it is looked at again each minute";
  EXPECT_EQ(slave_.value(kMapping), 0x60440010U);
}

TEST_F(NodeLifeTest, ASlowHeartbeatIsToldWhileItIsWaitedFor) {
  running(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 65'535);
  loop_.advance(10ms);
  start(bench_settings());
  loop_.advance(3s, 5ms);
  EXPECT_NE(status().boot_text.find("every 65535 ms"), std::string::npos) << status().boot_text;
  expect_untouched();
}

TEST_F(NodeLifeTest, LeftAloneItIsLookedAtAgainEachMinute) {
  running(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1s);
  ASSERT_EQ(status().boot_result, BootResult::left_alone);
  slave_.set({0x1800, 5}, DataType::u16, 100);
  loop_.advance(58s, 10ms);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(wait_online(3s));
  expect_untouched();
}

TEST_F(NodeLifeTest, LeftAloneItIsLookedAtAgainOnAStartCommand) {
  running(bench_settings());
  slave_.set({0x1800, 5}, DataType::u16, 0);
  start(bench_settings());
  loop_.advance(1s);
  const auto in_vain = command(NmtCommand::start);
  loop_.advance(800ms);
  ASSERT_TRUE(in_vain.done());
  EXPECT_EQ(in_vain.get().error().kind, ErrorKind::refused);
  EXPECT_NE(in_vain.get().error().detail.find("event timer"), std::string::npos) << in_vain.get().error().detail;
  slave_.set({0x1800, 5}, DataType::u16, 100);
  const auto started = command(NmtCommand::start);
  loop_.advance(800ms);
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().has_value()) << to_string(started.get().error());
  EXPECT_TRUE(status().online);
  expect_untouched();
}

TEST_F(NodeLifeTest, AMessageFromBeforeAResetIsNoSignOfItsState) {
  bring_online(bench_settings());
  slave_.ignore_nmt(true);
  slave_.heartbeat_off(true);
  ASSERT_TRUE(command_now(NmtCommand::reset_node).has_value());
  slave_.send(0x705, {5});
  slave_.mute_sdo(true);
  loop_.advance(1700ms);
  slave_.mute_sdo(false);
  slave_.ignore_nmt(false);
  slave_.heartbeat_off(false);
  says(127);
  ASSERT_TRUE(wait_online(3s)) << status().boot_text;
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(129), nmt(1)}));
}

TEST_F(NodeLifeTest, ADriveThatStartsItselfIsMadePreOperationalOnceWhereItsMotorStands) {
  NodeSettings settings = with_motor();
  settings.self_starting = true;
  install(settings);
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  slave_.set(kStatusWord, DataType::u16, 0x0650);
  slave_.delay_answers(2ms);
  refuse_pdo_settings_while_operational();
  start(settings);
  slave_.boot_up();
  loop_.advance(3ms);
  slave_.set_state(5);
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(128), nmt(1)}));
  EXPECT_EQ(slave_.value(kMapping), 0x60440010U);
}

TEST_F(NodeLifeTest, ADriveThatStartedItselfAndRunsIsLeftAlone) {
  NodeSettings settings = with_motor();
  settings.self_starting = true;
  install(settings);
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  slave_.set(kStatusWord, DataType::u16, 0x0627);
  slave_.delay_answers(2ms);
  refuse_pdo_settings_while_operational();
  start(settings);
  slave_.boot_up();
  loop_.advance(3ms);
  slave_.set_state(5);
  loop_.advance(70s, 10ms);
  EXPECT_FALSE(status().online);
  EXPECT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(NodeLifeTest, WithoutRestartADriveThatLeftIsNotStarted) {
  bring_online(with_motor());
  leave_operational();
  loop_.advance(120s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(NodeLifeTest, WithRestartItIsConfiguredAndStartedAgainLaterEachTime) {
  NodeSettings settings = with_motor();
  settings.restart = true;
  slave_.set(kStatusWord, DataType::u16, 0x0650);
  slave_.set(kControlWord, DataType::u16, 0x0006);
  bring_online(settings);
  slave_.set(kStatusWord, DataType::u16, 0x0650);
  for (const Duration pause : {5s, 10s, 20s}) {
    loop_.advance(2s);
    leave_operational();
    slave_.set({0x1800, 5}, DataType::u16, 0);
    loop_.advance(pause - 600ms, 10ms);
    EXPECT_TRUE(nmt_heard().empty());
    EXPECT_NE(status().boot_text.find("about to be configured"), std::string::npos) << status().boot_text;
    ASSERT_TRUE(loop_.advance_until([this] { return status().boot_result == BootResult::ok && status().online; }, 2s))
        << status().boot_text;
    EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
    EXPECT_EQ(slave_.value({0x1800, 5}), 100U);
    EXPECT_TRUE(slave_.heard_on(0x205).empty()) << "RPDOs stay silent";
  }
}

TEST_F(NodeLifeTest, ItIsNotStartedWhileItRunsHasAFaultOrHoldsARunCommand) {
  NodeSettings settings = with_motor();
  settings.restart = true;
  bring_online(settings);
  struct Forbidden {
    Raw status_word;
    Raw control_word;
    const char* text;
  };
  const std::vector<Forbidden> cases{{0x0627, 0x0006, "its motor runs"},
                                     {0x0618, 0x0006, "it has a fault"},
                                     {0x0640, 0x000F, "its control command holds 0xF, which is no stop"}};
  leave_operational();
  for (const Forbidden& forbidden : cases) {
    slave_.set(kStatusWord, DataType::u16, forbidden.status_word);
    slave_.set(kControlWord, DataType::u16, forbidden.control_word);
    loop_.advance(61s, 10ms);
    EXPECT_TRUE(nmt_heard().empty());
    EXPECT_NE(status().boot_text.find(forbidden.text), std::string::npos) << status().boot_text;
  }
  slave_.remove(kControlWord);
  loop_.advance(61s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_NE(status().boot_text.find("its control command cannot be read"), std::string::npos) << status().boot_text;
  slave_.set(kControlWord, DataType::u16, 0);
  loop_.advance(62s, 10ms);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(NodeLifeTest, ItIsNotStartedWhereAnotherMasterCommands) {
  NodeSettings settings = with_motor();
  settings.restart = true;
  slave_.set(kStatusWord, DataType::u16, 0x0650);
  slave_.set(kControlWord, DataType::u16, 0x0006);
  bring_online(settings);
  slave_.send(0x000, {128, 0});
  leave_operational();
  loop_.advance(120s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_NE(status().boot_text.find("another master"), std::string::npos) << status().boot_text;
}

TEST_F(NodeLifeTest, ADriveThatRefusesToStartSaysWhy) {
  install(bench_settings());
  slave_.set({0x1001, 0}, DataType::u8, 0x21);
  slave_.set({0x1003, 1}, DataType::u32, 0x00002310);
  slave_.ignore_nmt(true);
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(2500ms);
  EXPECT_EQ(status().boot_result, BootResult::not_configured);
  EXPECT_NE(status().boot_text.find("error register 0x1001 is 0x21, its newest error 0x1003:01 0x00002310"),
            std::string::npos)
      << status().boot_text;
}

}  // namespace
}  // namespace canopen
