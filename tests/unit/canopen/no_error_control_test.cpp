// Drives without heartbeat and guarding, by choice: TPDOs and SDO answers are the signs of their life.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

NodeSettings without_settings() {
  NodeSettings settings = with_motor();
  settings.error_control.heartbeat = Duration::zero();
  return settings;
}

class NoErrorControlTest : public NodeLifeBench {
 protected:
  void boot_without(const NodeSettings& settings = without_settings()) {
    install(settings);
    slave_.set(kHeartbeatTime, DataType::u16, 0);
    motor_stands();
    start(settings);
    slave_.boot_up();
    ASSERT_TRUE(wait_online()) << status().boot_text;
    loop_.advance(2s);
    slave_.forget_heard();
  }
  void motor_runs() {
    slave_.set(kStatusWord, DataType::u16, 0x0637);
    slave_.set(kControlWord, DataType::u16, 0x000F);
  }
  /// Of the next reads, whatever they are of.
  void lose_answers(unsigned count) {
    slave_.script([count](const Bytes& request) mutable -> Answers {
      if (request[0] != 0x40 || count == 0) {
        return std::nullopt;
      }
      --count;
      return std::vector<Bytes>{};
    });
  }
  /// Nothing that can move a motor is sent on a silent bus.
  void others_talk() {
    slave_.send(0x706, {5});
    loop_.settle();
  }
  void send_tpdos(Duration time) {
    for (Duration passed{}; passed < time; passed += 100ms) {
      send_tpdo(0x0650, 0);
      loop_.advance(100ms);
    }
  }
};

TEST_F(NoErrorControlTest, OnlineByTpdosItIsNotRead) {
  boot_without();
  send_tpdos(10s);
  EXPECT_TRUE(status().online);
  EXPECT_LE(Clock::now() - *status().last_heartbeat, 100ms);
  EXPECT_TRUE(slave_.reads().empty());
}

TEST_F(NoErrorControlTest, WithoutTpdosItIsReadOftenEnough) {
  boot_without();
  for (int i = 0; i < 1000; ++i) {
    loop_.advance(10ms, 5ms);
    ASSERT_TRUE(status().online);
    ASSERT_LE(Clock::now() - *status().last_heartbeat, 395ms);
  }
  EXPECT_GE(slave_.reads().size(), 25U);
  EXPECT_LE(slave_.reads().size(), 27U);
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(NoErrorControlTest, OneMissingAnswerIsNoLoss) {
  boot_without();
  motor_runs();
  lose_answers(1);
  loop_.advance(20s, 5ms);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(status().heartbeat_losses, 0U);
}

TEST_F(NoErrorControlTest, NorAreTwo) {
  boot_without();
  motor_runs();
  lose_answers(2);
  loop_.advance(20s, 5ms);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(status().heartbeat_losses, 0U);
}

TEST_F(NoErrorControlTest, ThreeAre) {
  boot_without();
  lose_answers(3);
  ASSERT_TRUE(loop_.advance_until([this] { return status().lost; }, 20s));
  EXPECT_EQ(status().heartbeat_losses, 1U);
}

TEST_F(NoErrorControlTest, AShortTimeOfAnAnswerIsNoFloodOfReads) {
  NodeSettings settings = without_settings();
  settings.sdo.timeout = 20ms;
  boot_without(settings);
  slave_.mute_sdo(true);
  ASSERT_TRUE(loop_.advance_until([this] { return status().lost; }, 2s));
  EXPECT_GE(slave_.reads().size(), 3U);
  EXPECT_LE(slave_.reads().size(), 4U);
}

TEST_F(NoErrorControlTest, AnAbortIsAnAnswerToo) {
  boot_without();
  slave_.remove({0x1000, 0});
  loop_.advance(10s, 5ms);
  EXPECT_TRUE(status().online);
}

TEST_F(NoErrorControlTest, SilenceOfBothIsALossAndAnAnswerTheReturn) {
  boot_without();
  slave_.unplug(true);
  loop_.advance(900ms);
  EXPECT_TRUE(status().online);
  loop_.advance(700ms);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(status().lost);
  EXPECT_EQ(status().heartbeat_losses, 1U);
  loop_.advance(20s, 5ms);
  EXPECT_EQ(status().heartbeat_losses, 1U);
  slave_.unplug(false);
  slave_.set_state(127);
  ASSERT_TRUE(wait_online(10s)) << status().boot_text;
  EXPECT_FALSE(status().lost);
}

TEST_F(NoErrorControlTest, ATpdoAloneKeepsItOnline) {
  boot_without();
  slave_.mute_sdo(true);
  send_tpdos(10s);
  EXPECT_TRUE(status().online);
  loop_.advance(1600ms);
  EXPECT_TRUE(status().lost);
}

TEST_F(NoErrorControlTest, ItsHeartbeatIsSwitchedOffInABoot) {
  install(without_settings());
  motor_stands();
  start(without_settings());
  slave_.boot_up();
  ASSERT_TRUE(wait_online()) << status().boot_text;
  EXPECT_EQ(slave_.value(kHeartbeatTime), 0U);
}

TEST_F(NoErrorControlTest, AHeartbeatOfARunningDriveWillDo) {
  running(without_settings());
  start(without_settings());
  ASSERT_TRUE(wait_online()) << status().boot_text;
  EXPECT_FALSE(events_.remarks.empty());
  expect_untouched();
}

TEST_F(NoErrorControlTest, StoppedByCommandItIsOfflineAndNotLostAndCanBeStarted) {
  boot_without();
  silent_when_stopped();
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(20s, 5ms);
  others_talk();
  EXPECT_FALSE(status().online) << "no sign of life within heartbeat_timeout";
  EXPECT_FALSE(status().lost);
  EXPECT_EQ(status().heartbeat_losses, 0U);
  EXPECT_EQ(status().nmt_now(), NmtState::stopped);
  const auto started = command(NmtCommand::start, 5s);
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  ASSERT_TRUE(started.done());
  EXPECT_TRUE(started.get().has_value());
  EXPECT_EQ(slave_.state(), 5);
}

// Held back by a command in a boot that began with another: what it answers then may be from before that one.
TEST_F(NoErrorControlTest, AnswersThatDoNotCountAreNoFloodOfReads) {
  boot_without();
  silent_when_stopped();
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(20s, 5ms);
  others_talk();
  std::optional<Sent> held;
  when_read(kLastRead, [&] { held.emplace(command(NmtCommand::pre_operational)); });
  const auto started = command(NmtCommand::start, 5s);
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  ASSERT_TRUE(held && held->done());
  ASSERT_EQ(slave_.state(), 127) << "held back";
  slave_.script({});
  slave_.delay_answers(1ms);
  slave_.forget_heard();
  loop_.advance(1s);
  EXPECT_TRUE(status().online);
  EXPECT_LE(slave_.reads().size(), 4U);
}

TEST_F(NoErrorControlTest, StoppedByCommandItCanBeMadePreOperational) {
  boot_without();
  silent_when_stopped();
  ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
  loop_.advance(20s, 5ms);
  others_talk();
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  EXPECT_TRUE(wait_online(10s)) << status().boot_text;
  EXPECT_EQ(slave_.state(), 127) << "and it is not started by that";
  EXPECT_EQ(status().nmt, NmtState::pre_operational);
}

}  // namespace
}  // namespace canopen
