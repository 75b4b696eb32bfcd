// `restart`: a node that left operational by itself is configured and started again, where nothing speaks against it.

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class RestartTest : public NodeLifeBench {
 protected:
  /// Online, and nothing will speak against starting it again.
  void bring_online_with_restart() {
    bring_online(settings_);
    motor_stands();
  }

  NodeSettings settings_ = [] {
    NodeSettings settings = with_motor();
    settings.restart = true;
    return settings;
  }();
};

TEST_F(RestartTest, WithoutRestartADriveThatLeftIsNotStarted) {
  bring_online(with_motor());
  leave_operational();
  loop_.advance(120s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(RestartTest, WithRestartItIsConfiguredAndStartedAgainLaterEachTime) {
  NodeSettings settings = with_motor();
  settings.restart = true;
  motor_stands();
  bring_online(settings);
  slave_.set(kStatusWord, DataType::u16, 0x0650);
  for (const Duration pause : {5s, 10s, 20s}) {
    loop_.advance(2s);
    leave_operational();
    slave_.set(kTpdoEventTimer, DataType::u16, 0);
    loop_.advance(pause - 600ms, 10ms);
    EXPECT_TRUE(nmt_heard().empty());
    EXPECT_NE(status().boot_text.find("about to be configured"), std::string::npos) << status().boot_text;
    ASSERT_TRUE(loop_.advance_until([this] { return status().boot_result == BootResult::ok && status().online; }, 2s))
        << status().boot_text;
    EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
    EXPECT_EQ(slave_.value(kTpdoEventTimer), 100U);
    EXPECT_TRUE(slave_.heard_on(0x205).empty()) << "RPDOs stay silent";
  }
}

TEST_F(RestartTest, GoesOnAfterOurOwnInterfaceWasDown) {
  bring_online_with_restart();
  loop_.advance(2s);
  leave_operational();
  wire_.set_state(BusState{});
  loop_.advance(3s);
  wire_.set_state({BusCondition::error_active, 0, 0});
  loop_.advance(1s);
  EXPECT_TRUE(nmt_heard().empty());
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
}

TEST_F(RestartTest, ItIsNotStartedWhileItRunsHasAFaultOrHoldsARunCommand) {
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

TEST_F(RestartTest, ItIsNotStartedWhereAnotherMasterCommands) {
  NodeSettings settings = with_motor();
  settings.restart = true;
  motor_stands();
  bring_online(settings);
  slave_.send(0x000, {128, 0});
  leave_operational();
  loop_.advance(120s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_NE(status().boot_text.find("another master"), std::string::npos) << status().boot_text;
}

TEST_F(RestartTest, AnotherMastersCommandWhileTheMotorIsReadPreventsIt) {
  bring_online_with_restart();
  slave_.delay_answers(50ms);
  leave_operational();
  ASSERT_TRUE(loop_.advance_until([this] { return !slave_.reads().empty(); }, 10s));
  slave_.send(0x000, {128, 0});
  loop_.advance(20s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(RestartTest, PreOperationalByCommandIsNotUndoneByIt) {
  bring_online_with_restart();
  leave_operational();
  loop_.advance(1s);
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(20s, 10ms);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
}

TEST_F(RestartTest, PreOperationalByCommandWhileItIsConfiguredAgainIsKept) {
  bring_online_with_restart();
  slave_.delay_answers(20ms);
  leave_operational();
  ASSERT_TRUE(loop_.advance_until([this] { return !status().online; }, 10s));
  loop_.advance(50ms);
  ASSERT_FALSE(status().configured);
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(60s, 10ms);
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(128)});
}

TEST_F(RestartTest, AStopByCommandIsNotUndoneByIt) {
  bring_online_with_restart();
  leave_operational();
  loop_.advance(500ms);
  const auto sent = command(NmtCommand::stop);
  loop_.advance(60s, 10ms);
  ASSERT_TRUE(sent.done() && sent.get().has_value());
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(2)});
}

TEST_F(RestartTest, ARunCommandGivenWhileItIsConfiguredPreventsIt) {
  bring_online_with_restart();
  leave_operational();
  when_read(kLastRead, [this] { slave_.set(kControlWord, DataType::u16, 0x000F); });
  loop_.advance(30s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_TRUE(told("its control command holds 0xF")) << status().boot_text;
}

// The look at the motor is worth nothing once somebody may have given a run command since: a start that was ignored, or
// a configuration that failed, must not be followed by a start without another look.
TEST_F(RestartTest, AfterAStartThatWasIgnoredTheMotorIsLookedAtAgain) {
  bring_online_with_restart();
  leave_operational();
  slave_.ignore_nmt(true);
  ASSERT_TRUE(wait_nmt(10s));
  loop_.advance(1s);
  slave_.set(kControlWord, DataType::u16, 0x000F);  // The panel, or another master, writes a run command.
  slave_.ignore_nmt(false);
  slave_.forget_heard();
  loop_.advance(30s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_TRUE(told("its control command holds 0xF")) << status().boot_text;
}

TEST_F(RestartTest, AfterAConfigurationThatFailedTheMotorIsLookedAtAgain) {
  bring_online_with_restart();
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  slave_.ignore_write(kMapping);
  leave_operational();
  loop_.advance(8s, 10ms);
  ASSERT_TRUE(told("after it was written")) << status().boot_text;
  slave_.set(kControlWord, DataType::u16, 0x000F);
  slave_.set(kMapping, DataType::u32, kWantedMapping);  // The next configuration would succeed.
  loop_.advance(60s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_TRUE(told("its control command holds 0xF")) << status().boot_text;
}

TEST_F(RestartTest, AfterAConfigurationThatFailedAnotherMastersCommandStillPreventsIt) {
  bring_online_with_restart();
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  slave_.ignore_write(kMapping);
  leave_operational();
  loop_.advance(8s, 10ms);
  ASSERT_TRUE(told("after it was written")) << status().boot_text;
  slave_.set(kMapping, DataType::u32, kWantedMapping);
  slave_.send(0x000, {128, 0});
  loop_.advance(60s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_TRUE(told("another master")) << status().boot_text;
}

TEST_F(RestartTest, NothingIsStartedWhileTheGatewayEnds) {
  bring_online_with_restart();
  leave_operational();
  node_->close();
  loop_.advance(20s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
}

}  // namespace
}  // namespace canopen
