// `self_starting`: a drive that goes operational by itself after its boot-up, before it can be configured.

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SelfStartingTest : public NodeLifeBench {
 protected:
  /// It boots with another mapping, and is about to start itself. Like most it takes PDO settings only before that.
  void boot_up_differing(Raw status_word, Duration answer_delay) {
    NodeSettings settings = with_motor();
    settings.self_starting = true;
    install(settings);
    slave_.set(kMapping, DataType::u32, kOtherMapping);
    slave_.set(kStatusWord, DataType::u16, status_word);
    slave_.delay_answers(answer_delay);
    slave_.script([this](const Bytes& request) { return refused_while_operational(request); });
    start(settings);
    slave_.boot_up();
    loop_.advance(3ms);
  }
};

TEST_F(SelfStartingTest, WhereItsMotorStandsItIsMadePreOperationalOnce) {
  boot_up_differing(0x0650, 2ms);
  slave_.set_state(5);
  ASSERT_TRUE(wait_online(5s)) << status().boot_text;
  EXPECT_EQ(nmt_heard(), (std::vector<Frame>{nmt(128), nmt(1)}));
  EXPECT_EQ(slave_.value(kMapping), kWantedMapping);
}

TEST_F(SelfStartingTest, WhereItsMotorRunsItIsLeftAlone) {
  boot_up_differing(0x0627, 2ms);
  slave_.set_state(5);
  loop_.advance(70s, 10ms);
  EXPECT_FALSE(status().online);
  EXPECT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
  EXPECT_TRUE(nmt_heard().empty());
}

// The bus may have been busy, or the answer lost: nothing was learnt of the motor, so nothing is decided.
TEST_F(SelfStartingTest, AMotorThatCouldNotBeReadIsLookedAtAgain) {
  boot_up_differing(0x0650, 2ms);
  bool mute = true;
  slave_.script([this, &mute](const Bytes& request) -> Answers {
    const bool muted = mute && reads(request, kStatusWord);
    return muted ? Answers(std::vector<Bytes>{}) : refused_while_operational(request);
  });
  says(5);
  loop_.advance(5s, 5ms);
  EXPECT_TRUE(nmt_heard().empty());
  mute = false;
  loop_.advance(130s, 10ms);
  EXPECT_TRUE(status().online) << status().boot_text;
  slave_.script({});
}

TEST_F(SelfStartingTest, WhatAnotherMasterStartedIsNotMadePreOperational) {
  boot_up_differing(0x0650, 5ms);
  loop_.advance(5ms);
  slave_.send(0x000, {1, 0});
  says(5);
  loop_.advance(20s, 10ms);
  EXPECT_TRUE(nmt_heard().empty());
  EXPECT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
}

TEST_F(SelfStartingTest, PreOperationalByCommandWhileItIsInspectedIsKept) {
  boot_up_differing(0x0650, 5ms);
  says(5);
  loop_.advance(20ms);
  const auto sent = command(NmtCommand::pre_operational);
  loop_.advance(20s, 10ms);
  ASSERT_TRUE(sent.done() && sent.get().has_value());
  EXPECT_EQ(starts(), 0);
}

}  // namespace
}  // namespace canopen
