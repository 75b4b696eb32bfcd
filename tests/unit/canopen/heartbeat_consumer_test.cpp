#include "canopen/heartbeat_consumer.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/hand_driven_loop.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

std::optional<HeartbeatMessage> decode(std::vector<std::uint8_t> bytes) {
  return decode_heartbeat(bytes);
}

TEST(HeartbeatMessageTest, StatesIgnoreTheToggleBit) {
  EXPECT_EQ(decode({0x05}), (HeartbeatMessage{false, NmtState::operational}));
  EXPECT_EQ(decode({0x85}), (HeartbeatMessage{false, NmtState::operational}));
  EXPECT_EQ(decode({0x04}), (HeartbeatMessage{false, NmtState::stopped}));
  EXPECT_EQ(decode({0x7F}), (HeartbeatMessage{false, NmtState::pre_operational}));
  EXPECT_EQ(decode({0xFF}), (HeartbeatMessage{false, NmtState::pre_operational}));
}

TEST(HeartbeatMessageTest, BootUpIsNoState) {
  EXPECT_EQ(decode({0x00}), (HeartbeatMessage{true, NmtState::initialising}));
  EXPECT_FALSE(decode({0x80})->boot_up);
}

TEST(HeartbeatMessageTest, UnknownNumbersAreSignsOfLifeOnly) {
  EXPECT_EQ(decode({0x06}), (HeartbeatMessage{false, NmtState::unknown}));
  EXPECT_EQ(decode({0x80}), (HeartbeatMessage{false, NmtState::unknown}));
  EXPECT_EQ(decode({}), std::nullopt);
}

class HeartbeatConsumerTest : public testing::Test {
 protected:
  support::HandDrivenLoop loop_;
  int silences_ = 0;
  HeartbeatConsumer consumer_{loop_.executor(), 1500ms, [this] { ++silences_; }};
};

TEST_F(HeartbeatConsumerTest, SilenceIsToldOnceAndAtItsTime) {
  consumer_.watch(Clock::now());
  loop_.advance(1499ms);
  EXPECT_EQ(silences_, 0);
  loop_.advance(1ms);
  EXPECT_EQ(silences_, 1);
  EXPECT_FALSE(consumer_.watching());
  loop_.advance(10s);
  EXPECT_EQ(silences_, 1);
}

TEST_F(HeartbeatConsumerTest, MessagesMoveTheEnd) {
  consumer_.watch(Clock::now());
  for (int i = 0; i < 20; ++i) {
    loop_.advance(500ms);
    consumer_.alive(Clock::now());
  }
  EXPECT_EQ(silences_, 0);
  loop_.advance(1499ms);
  EXPECT_EQ(silences_, 0);
  loop_.advance(1ms);
  EXPECT_EQ(silences_, 1);
}

TEST_F(HeartbeatConsumerTest, SuspendedItTellsNothing) {
  consumer_.watch(Clock::now());
  consumer_.suspend();
  loop_.advance(10s);
  EXPECT_EQ(silences_, 0);
  consumer_.watch(Clock::now());
  loop_.advance(1500ms);
  EXPECT_EQ(silences_, 1);
}

TEST_F(HeartbeatConsumerTest, WithoutTimeoutItNeverTells) {
  HeartbeatConsumer never(loop_.executor(), Duration::zero(), [this] { ++silences_; });
  never.watch(Clock::now());
  loop_.advance(100s);
  EXPECT_EQ(silences_, 0);
}

}  // namespace
}  // namespace canopen
