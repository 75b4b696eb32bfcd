#include "canopen/node/heartbeat_consumer.h"

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
  TimePoint heard_until_ = kNever;  ///< Of the link; kNever: it never lags behind.
  HeartbeatConsumer consumer_{loop_.executor(), 1500ms, [this] { ++silences_; },
                              [this](TimePoint until) { return Clock::now() < until || heard_until_ < until; }};
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

TEST_F(HeartbeatConsumerTest, WhileAMessageMayWaitUnreadNothingIsTold) {
  consumer_.watch(Clock::now());
  heard_until_ = Clock::now() + 1499ms;
  loop_.advance(5s);
  EXPECT_EQ(silences_, 0);
  consumer_.alive(Clock::now() - 4s);  // Read late, received in time.
  heard_until_ = Clock::now() - 2501ms;
  loop_.advance(10ms);
  EXPECT_EQ(silences_, 0) << "silent for 1499 ms as far as was read";
  heard_until_ = Clock::now();
  loop_.advance(2ms);
  EXPECT_EQ(silences_, 1);
}

TEST_F(HeartbeatConsumerTest, AfterALossOfFramesSilenceCountsAnew) {
  consumer_.watch(Clock::now());
  loop_.advance(1400ms);
  consumer_.frames_lost(Clock::now());
  loop_.advance(1499ms);
  EXPECT_EQ(silences_, 0);
  loop_.advance(1ms);
  EXPECT_EQ(silences_, 1);
}

TEST_F(HeartbeatConsumerTest, LossesWithoutEndHideASilentNodeForTwoTimeoutsOnly) {
  consumer_.watch(Clock::now());
  for (int i = 0; i < 29; ++i) {
    consumer_.frames_lost(Clock::now());
    loop_.advance(100ms);
  }
  EXPECT_EQ(silences_, 0);
  for (int i = 0; i < 2; ++i) {
    consumer_.frames_lost(Clock::now());
    loop_.advance(100ms);
  }
  EXPECT_EQ(silences_, 1);
}

TEST_F(HeartbeatConsumerTest, WithoutTimeoutItNeverTells) {
  HeartbeatConsumer never(
      loop_.executor(), Duration::zero(), [this] { ++silences_; },
      [](TimePoint until) { return Clock::now() < until; });
  never.watch(Clock::now());
  loop_.advance(100s);
  EXPECT_EQ(silences_, 0);
}

}  // namespace
}  // namespace canopen
