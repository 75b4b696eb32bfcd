// Node guarding as master (CiA 301 §7.2.8.2.2): drives without heartbeat, the toggle bit, life guarding of others.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "canopen/communication_objects.h"
#include "canopen/node/life_guarding.h"
#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class NodeGuardingTest : public NodeLifeBench {
 protected:
  /// A drive with guarding, and no heartbeat.
  void install_guarded(const NodeSettings& settings) {
    install(settings);
    slave_.set(kHeartbeatTime, DataType::u16, 0);
    slave_.set(kGuardTime, DataType::u16, 0);
    slave_.set(kLifeTimeFactor, DataType::u8, 0);
    slave_.answer_guarding(true);
    motor_stands();
  }
  void boot_guarded(const NodeSettings& settings) {
    install_guarded(settings);
    start(settings);
    slave_.boot_up();
    ASSERT_TRUE(wait_online()) << status().boot_text;
  }
  void run_guarded(const NodeSettings& settings) {
    install_guarded(settings);
    slave_.set_state(5);
    start(settings);
  }
  void arm_life_guarding() {
    slave_.set(kGuardTime, DataType::u16, 300);
    slave_.set(kLifeTimeFactor, DataType::u8, 3);
  }
  [[nodiscard]] std::vector<Frame> requests() const { return slave_.heard_on(0x705); }
  [[nodiscard]] bool remarked(const std::string& part) const {
    return std::any_of(events_.remarks.begin(), events_.remarks.end(),
                       [&](const std::string& remark) { return remark.find(part) != std::string::npos; });
  }
};

TEST_F(NodeGuardingTest, BootedByItsBootUpAndSupervisedByRequests) {
  boot_guarded(guarded_each(500ms));
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::booted});
  EXPECT_EQ(nmt_heard(), std::vector<Frame>{nmt(1)});
  EXPECT_TRUE(slave_.writes().empty()) << "0x100C and 0x100D are only read";
  slave_.forget_heard();
  loop_.advance(10s);
  ASSERT_EQ(requests().size(), 20U);
  EXPECT_TRUE(requests()[0].remote);
  EXPECT_EQ(requests()[0].size, 1U);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(status().nmt, NmtState::operational);
  EXPECT_LE(Clock::now() - *status().last_heartbeat, 500ms);
  EXPECT_EQ(status().heartbeat_losses, 0U);
  EXPECT_TRUE(events_.remarks.empty()) << events_.remarks[0];
}

TEST_F(NodeGuardingTest, NoRequestBeforeBothObjectsWereRead) {
  install_guarded(guarded_each(500ms));
  start(guarded_each(500ms));
  slave_.boot_up();
  ASSERT_TRUE(wait_online());
  const std::vector<Frame>& heard = slave_.heard();
  const auto first = std::find_if(heard.begin(), heard.end(), [](const Frame& frame) { return frame.remote; });
  ASSERT_NE(first, heard.end());
  const auto read_before = [&](ObjectAddress object) {
    return std::any_of(heard.begin(), first, [&](const Frame& frame) {
      return frame.id == 0x605 && reads(Bytes(frame.data.begin(), frame.data.end()), object);
    });
  };
  EXPECT_TRUE(read_before(kGuardTime));
  EXPECT_TRUE(read_before(kLifeTimeFactor));
}

TEST_F(NodeGuardingTest, WithoutTheObjectsThereIsNoLifeGuardingToStart) {
  install_guarded(guarded_each(500ms));
  slave_.remove(kGuardTime);
  slave_.remove(kLifeTimeFactor);
  start(guarded_each(500ms));
  slave_.boot_up();
  EXPECT_TRUE(wait_online()) << status().boot_text;
}

TEST_F(NodeGuardingTest, AHeartbeatIsSwitchedOffFirst) {
  install_guarded(guarded_each(500ms));
  slave_.set(kHeartbeatTime, DataType::u16, 500);
  start(guarded_each(500ms));
  slave_.boot_up();
  ASSERT_TRUE(wait_online()) << status().boot_text;
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kHeartbeatTime});
  EXPECT_EQ(slave_.value(kHeartbeatTime), 0U);
}

TEST_F(NodeGuardingTest, FoundRunningItIsTakenOver) {
  run_guarded(guarded_each(500ms));
  ASSERT_TRUE(wait_online(4s)) << status().boot_text;
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::taken_over});
  EXPECT_EQ(status().nmt, NmtState::operational);
  expect_untouched();
}

TEST_F(NodeGuardingTest, ARunningDriveWithAHeartbeatThatFitsIsSupervisedByThat) {
  install_guarded(guarded_each(500ms));
  slave_.set(kHeartbeatTime, DataType::u16, 400);
  slave_.set_state(5);
  start(guarded_each(500ms));
  ASSERT_TRUE(wait_online()) << status().boot_text;
  EXPECT_TRUE(remarked("0x1017:00 heartbeat time: expected 0, found 400, which will do"));
  loop_.advance(10s, 5ms);
  EXPECT_TRUE(requests().empty());
  EXPECT_TRUE(status().online);
  expect_untouched();
}

TEST_F(NodeGuardingTest, SilenceIsALossAndItsReturnIsFound) {
  boot_guarded(guarded_each(500ms));
  loop_.advance(3s);
  slave_.unplug(true);
  loop_.advance(1400ms);
  EXPECT_TRUE(status().online);
  loop_.advance(600ms);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(status().lost);
  EXPECT_EQ(status().heartbeat_losses, 1U);
  loop_.advance(10s, 5ms);
  slave_.forget_heard();
  slave_.unplug(false);
  ASSERT_TRUE(wait_online(12s)) << status().boot_text;
  EXPECT_FALSE(status().lost);
  EXPECT_EQ(events_.arrivals, (std::vector<Arrival>{Arrival::booted, Arrival::taken_over}));
  EXPECT_EQ(status().heartbeat_losses, 1U);
}

TEST_F(NodeGuardingTest, ItsBootUpIsABoot) {
  boot_guarded(guarded_each(500ms));
  loop_.advance(3300ms);
  slave_.boot_up();
  loop_.settle();
  EXPECT_FALSE(status().online);
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(events_.arrivals, (std::vector<Arrival>{Arrival::booted, Arrival::booted}));
  EXPECT_TRUE(events_.remarks.empty()) << events_.remarks[0];
}

TEST_F(NodeGuardingTest, LeavingOperationalIsToldByTheNextAnswer) {
  boot_guarded(guarded_each(500ms));
  loop_.advance(3s);
  slave_.forget_heard();
  slave_.set_state(127);
  loop_.advance(600ms);
  EXPECT_EQ(status().nmt, NmtState::pre_operational);
  EXPECT_EQ(status().boot_result, BootResult::not_configured);
  EXPECT_TRUE(told("left operational by itself"));
  loop_.advance(20s, 5ms);
  EXPECT_GE(requests().size(), 40U) << "it is watched on";
  EXPECT_FALSE(status().lost);
}

TEST_F(NodeGuardingTest, WithoutAnswersItIsLetterF) {
  install_guarded(guarded_each(500ms));
  slave_.answer_guarding(false);
  boot(guarded_each(500ms));
  expect_letter(BootResult::no_guarding, "no guarding answer within 1500 ms");
}

TEST_F(NodeGuardingTest, AStoppedOneIsKnownAsStopped) {
  boot_guarded(guarded_each(500ms));
  loop_.advance(3s);
  const auto stopped = command(NmtCommand::stop);
  loop_.advance(2s, 1ms);
  ASSERT_TRUE(stopped.done() && stopped.get().has_value());
  EXPECT_EQ(status().nmt, NmtState::stopped);
  EXPECT_TRUE(status().online);
  EXPECT_FALSE(status().lost);
}

// ---- The toggle bit.

TEST_F(NodeGuardingTest, OneLostAnswerIsARemarkAndNoLoss) {
  boot_guarded(guarded_each(500ms));
  loop_.advance(3s);
  slave_.answer_guarding(false);
  loop_.advance(500ms);
  slave_.answer_guarding(true);
  slave_.send(0x705, {0x05});  // Whatever its bit is, one of these two repeats it.
  slave_.send(0x705, {0x05});
  loop_.settle();
  EXPECT_TRUE(remarked("toggle bit"));
  loop_.advance(10s);
  EXPECT_EQ(status().heartbeat_losses, 0U);
  EXPECT_TRUE(status().online);
  EXPECT_EQ(events_.remarks.size(), 1U);
}

TEST_F(NodeGuardingTest, AToggleBitThatStandsStillIsNoSignOfLife) {
  boot_guarded(guarded_each(500ms));
  loop_.advance(3s);
  slave_.toggle(false);
  loop_.advance(2600ms);
  EXPECT_TRUE(status().lost);
  EXPECT_EQ(status().heartbeat_losses, 1U);
  EXPECT_EQ(std::count_if(events_.remarks.begin(), events_.remarks.end(),
                          [](const std::string& remark) { return remark.find("toggle bit") != std::string::npos; }),
            1)
      << "told once, not each time";
  loop_.advance(60s, 5ms);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(status().lost);
  EXPECT_EQ(status().heartbeat_losses, 1U) << "nothing flaps";
  slave_.toggle(true);
  EXPECT_TRUE(wait_online(70s)) << status().boot_text;
  EXPECT_FALSE(status().lost);
}

TEST_F(NodeGuardingTest, ABootWithAToggleBitThatStandsStillIsLetterF) {
  install_guarded(guarded_each(500ms));
  slave_.toggle(false);
  boot(guarded_each(500ms));
  expect_letter(BootResult::no_guarding, "alternating toggle bits");
}

TEST_F(NodeGuardingTest, FoundRunningWithAToggleBitThatStandsStillItIsLetterE) {
  slave_.toggle(false);
  run_guarded(guarded_each(500ms));
  loop_.advance(4s);
  expect_letter(BootResult::no_error_control, "alternating toggle bits");
  loop_.advance(60s, 5ms);
  EXPECT_TRUE(events_.arrivals.empty());
  expect_untouched();
}

TEST_F(NodeGuardingTest, AfterABootUpTheFirstAnswerHasTheBitZero) {
  boot_guarded(guarded_each(500ms));
  loop_.advance(3s);
  slave_.answer_guarding(false);
  slave_.boot_up();
  ASSERT_TRUE(loop_.advance_until([this] { return !requests().empty() && !status().online; }, 1s));
  loop_.advance(300ms);
  slave_.send(0x705, {0xFF});
  loop_.settle();
  EXPECT_TRUE(remarked("toggle bit"));
  EXPECT_EQ(status().nmt, NmtState::initialising) << "handled as if it was not received";
}

// ---- Life guarding.

TEST_F(NodeGuardingTest, BootedWithLifeGuardingOfAnotherMasterItIsLetterJAndNotOneRequestIsSent) {
  install_guarded(guarded_each(500ms));
  slave_.set(kHeartbeatTime, DataType::u16, 700);
  arm_life_guarding();
  boot(guarded_each(500ms));
  expect_letter(BootResult::not_configured, "another master has set life guarding");
  EXPECT_TRUE(told("0x100C:00 guard time is 300 ms and 0x100D:00 life time factor 3"));
  loop_.advance(60s, 5ms);
  EXPECT_TRUE(requests().empty());
  EXPECT_TRUE(slave_.writes().empty()) << "nor is its heartbeat taken away";
}

TEST_F(NodeGuardingTest, FoundRunningWithItItIsLeftAloneAndNotOneRequestIsSent) {
  install_guarded(guarded_each(500ms));
  arm_life_guarding();
  slave_.set_state(5);
  start(guarded_each(500ms));
  for (int i = 0; i < 600; ++i) {
    send_tpdo(0x0627, 1);
    loop_.advance(100ms, 5ms);
  }
  expect_left_alone("another master has set life guarding");
  EXPECT_TRUE(requests().empty());
}

TEST_F(NodeGuardingTest, WhereNothingTellsAndItsMotorRunsItIsLeftAlone) {
  install_guarded(guarded_each(500ms));
  arm_life_guarding();
  slave_.set(kStatusWord, DataType::u16, 0x0627);
  slave_.set_state(5);
  start(guarded_each(500ms));
  loop_.advance(60s, 5ms);
  expect_left_alone("its motor runs");
  EXPECT_TRUE(requests().empty());
}

TEST_F(NodeGuardingTest, OneOfBothObjectsAloneIsNoLifeGuarding) {
  install_guarded(guarded_each(500ms));
  slave_.set(kGuardTime, DataType::u16, 300);
  start(guarded_each(500ms));
  slave_.boot_up();
  EXPECT_TRUE(wait_online()) << status().boot_text;
  EXPECT_EQ(slave_.value(kGuardTime), 300U) << "left as it is";
}

TEST_F(NodeGuardingTest, UnreadableObjectsAreNoPermission) {
  install_guarded(guarded_each(500ms));
  slave_.mute(kLifeTimeFactor);
  boot(guarded_each(500ms));
  loop_.advance(30s, 5ms);
  expect_letter(BootResult::not_configured, "0x100D:00");
  EXPECT_TRUE(requests().empty());
}

TEST_F(NodeGuardingTest, SuperviseGatewaySetsLifeGuardingBeforeTheFirstRequest) {
  NodeSettings settings = guarded_each(500ms);
  settings.error_control.supervise_gateway = 1600ms;
  install_guarded(settings);
  arm_life_guarding();
  start(settings);
  slave_.boot_up();
  ASSERT_TRUE(wait_online()) << status().boot_text;
  EXPECT_EQ(slave_.value(kGuardTime), 500U);
  EXPECT_EQ(slave_.value(kLifeTimeFactor), 4U) << "rounded up";
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{kGuardTime, kLifeTimeFactor}));
  const std::vector<Frame>& heard = slave_.heard();
  const auto last_write = std::find_if(heard.rbegin(), heard.rend(), [](const Frame& frame) {
    return frame.id == 0x605 && (frame.data[0] & 0xE0U) == 0x20;
  });
  EXPECT_TRUE(std::none_of(last_write, heard.rend(), [](const Frame& frame) { return frame.remote; }));
}

TEST_F(NodeGuardingTest, OurOwnLifeGuardingIsKnownAgain) {
  NodeSettings settings = guarded_each(500ms);
  settings.error_control.supervise_gateway = 1600ms;
  install_guarded(settings);
  slave_.set(kGuardTime, DataType::u16, 500);
  slave_.set(kLifeTimeFactor, DataType::u8, 4);
  slave_.set_state(5);
  start(settings);
  ASSERT_TRUE(wait_online(4s)) << status().boot_text;
  expect_untouched();
}

TEST_F(NodeGuardingTest, ARunningDriveWithOtherLifeGuardingIsLeftAlone) {
  NodeSettings settings = guarded_each(500ms);
  settings.error_control.supervise_gateway = 1600ms;
  install_guarded(settings);
  arm_life_guarding();
  slave_.set_state(5);
  start(settings);
  send_tpdo(0x0627, 1);
  loop_.advance(1s);
  expect_left_alone("0x100C:00 guard time: expected 500, found 300");
  EXPECT_TRUE(requests().empty());
}

TEST(LifeGuardingTest, WhatIsWrittenIsThePeriodAndTheFactorRoundedUp) {
  ErrorControlSettings control{.heartbeat = Duration::zero(), .guarding = 300ms, .supervise_gateway = 900ms};
  EXPECT_EQ(wanted_life_guarding(control), (LifeGuarding{300, 3}));
  control.supervise_gateway = 901ms;
  EXPECT_EQ(wanted_life_guarding(control), (LifeGuarding{300, 4}));
  control.supervise_gateway = Duration::zero();
  EXPECT_TRUE(wanted_life_guarding(control).unset());
  control = {.heartbeat = 500ms, .supervise_gateway = 900ms};
  EXPECT_TRUE(wanted_life_guarding(control).unset()) << "a heartbeat is supervised by 0x1016";
}

TEST(LifeGuardingTest, ARequestIsHarmlessWhereNothingIsArmedOrByUs) {
  const ErrorControlSettings control{.heartbeat = Duration::zero(), .guarding = 300ms, .supervise_gateway = 900ms};
  EXPECT_TRUE(may_guard({0, 0}, control));
  EXPECT_TRUE(may_guard({500, 0}, control));
  EXPECT_TRUE(may_guard({0, 3}, control));
  EXPECT_TRUE(may_guard({300, 3}, control));
  EXPECT_FALSE(may_guard({300, 4}, control));
  EXPECT_FALSE(may_guard({500, 3}, control));
  EXPECT_FALSE(may_guard({300, 3}, {.heartbeat = Duration::zero(), .guarding = 300ms}));
}

}  // namespace
}  // namespace canopen
