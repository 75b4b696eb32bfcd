// Heartbeats, node guarding, heartbeat consumer, EMCY bookkeeping.
#include <gtest/gtest.h>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

constexpr std::uint8_t kGuarded = 20;
constexpr std::uint32_t kStatus = 0x700U + kGuarded;
constexpr std::uint32_t kEmergency = 0x80U + kGuarded;

class Guarded : public ::testing::TestWithParam<const char*> {};

TEST_P(Guarded, AnswersRemoteRequestsWithAToggleBit) {
  OneDrive bench(GetParam(), kGuarded);
  bench.remote_request(kStatus);
  EXPECT_EQ(bench.take(kStatus), std::vector{frame(kStatus, {0x7F})});
  bench.remote_request(kStatus);
  EXPECT_EQ(bench.take(kStatus), std::vector{frame(kStatus, {0xFF})});
  bench.start();
  bench.remote_request(kStatus);
  EXPECT_EQ(bench.take(kStatus), std::vector{frame(kStatus, {0x05})});
  bench.remote_request(kStatus);
  EXPECT_EQ(bench.take(kStatus), std::vector{frame(kStatus, {0x85})});
  bench.remote_request(kStatus + 1);
  EXPECT_TRUE(bench.take(kStatus).empty());
}

TEST_P(Guarded, NotWhileItSendsHeartbeats) {
  OneDrive bench(GetParam(), kGuarded);
  ASSERT_EQ(bench.write(kGuarded, 0x1017, 0, 500, 2), 0U);
  bench.remote_request(kStatus);
  EXPECT_TRUE(bench.take(kStatus).empty());
  ASSERT_EQ(bench.write(kGuarded, 0x1017, 0, 0, 2), 0U);
  bench.remote_request(kStatus);
  EXPECT_EQ(bench.take(kStatus).size(), 1U);
}

TEST_P(Guarded, MissesItsMasterAfterTheLifeTime) {
  OneDrive bench(GetParam(), kGuarded);
  ASSERT_EQ(bench.write(kGuarded, 0x100C, 0, 100, 2), 0U);
  ASSERT_EQ(bench.write(kGuarded, 0x100D, 0, 3, 1), 0U);
  bench.start();
  bench.advance(seconds(2));  // armed by the first request only
  EXPECT_TRUE(bench.take(kEmergency).empty());
  bench.remote_request(kStatus);
  bench.advance(milliseconds(299));
  EXPECT_TRUE(bench.take(kEmergency).empty());
  bench.advance(milliseconds(1));
  const auto emergencies = bench.take(kEmergency);
  ASSERT_FALSE(emergencies.empty());
  EXPECT_EQ(word_at(emergencies[0], 0), 0x8130);
  EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);
}

TEST_P(Guarded, TheToggleBitCanStandStill) {
  OneDrive bench(GetParam(), kGuarded);
  bench.drive().misbehaviour().toggle_stuck = true;
  for (int i = 0; i < 3; ++i) {
    bench.remote_request(kStatus);
    EXPECT_EQ(bench.take(kStatus), std::vector{frame(kStatus, {0x7F})});
  }
  bench.drive().misbehaviour().toggle_stuck = false;
  bench.remote_request(kStatus);
  EXPECT_EQ(bench.take(kStatus), std::vector{frame(kStatus, {0xFF})}) << "it went on counting";
}

TEST_P(Guarded, LifeGuardingCanBeStored) {
  DriveOptions options;
  options.guard_ms = 100;
  options.life_factor = 3;
  OneDrive bench(GetParam(), kGuarded, options);
  EXPECT_EQ(bench.read(kGuarded, 0x100C, 0), 100U);
  EXPECT_EQ(bench.read(kGuarded, 0x100D, 0), 3U);
  bench.advance(seconds(2));
  EXPECT_TRUE(bench.take(kEmergency).empty());
  bench.remote_request(kStatus);
  bench.advance(milliseconds(300));
  const auto emergencies = bench.take(kEmergency);
  ASSERT_FALSE(emergencies.empty());
  EXPECT_EQ(word_at(emergencies[0], 0), 0x8130);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Guarded, ::testing::Values("invt-goodrive600", "vacon-opte6", "cia402-velocity"));

TEST(Unguarded, VeichiKnowsNoGuarding) {
  OneDrive bench("veichi-ac300", kGuarded);
  bench.remote_request(kStatus);
  EXPECT_TRUE(bench.heard.empty());
  EXPECT_EQ(bench.read_abort(kGuarded, 0x100C, 0), 0x06020000U);
  EXPECT_EQ(bench.read_abort(kGuarded, 0x1016, 1), 0x06020000U);
  EXPECT_EQ(bench.read_abort(kGuarded, 0x1018, 1), 0x06020000U);
}

TEST(Heartbeat, IsNeverToggledAndFollowsItsTime) {
  OneDrive bench("cia402-velocity", kGuarded);
  ASSERT_EQ(bench.write(kGuarded, 0x1017, 0, 50, 2), 0U);
  bench.advance(milliseconds(150));
  EXPECT_EQ(bench.take(kStatus), std::vector(3, frame(kStatus, {0x7F})));
  ASSERT_EQ(bench.write(kGuarded, 0x1017, 0, 400, 2), 0U);
  bench.advance(milliseconds(399));
  EXPECT_TRUE(bench.take(kStatus).empty());
  bench.advance(milliseconds(1));
  EXPECT_EQ(bench.take(kStatus).size(), 1U);
  EXPECT_EQ(bench.drive().record().heartbeats, 4U);
}

class Consumer : public ::testing::TestWithParam<const char*> {
 protected:
  void heartbeat(Bench& bench) { bench.send(0x700U + 1, {0x05}); }
};

TEST_P(Consumer, TripsWhenTheMastersHeartbeatIsLost) {
  OneDrive bench(GetParam(), kGuarded);
  ASSERT_EQ(bench.write(kGuarded, 0x1016, 2, 1U << 16U | 300U, 4), 0U);
  bench.start();
  bench.write(kGuarded, 0x6042, 0, 600, 2);
  for (const std::uint32_t word : {0x06U, 0x07U, 0x7FU}) {
    ASSERT_EQ(bench.write(kGuarded, 0x6040, 0, word, 2), 0U);
  }
  bench.advance(seconds(3));  // no heartbeat yet, so nothing is missed
  EXPECT_GT(bench.drive().motor().output_hz(), 15.0);
  for (int i = 0; i < 10; ++i) {
    heartbeat(bench);
    bench.advance(milliseconds(200));
  }
  EXPECT_TRUE(bench.take(kEmergency).empty());
  bench.advance(milliseconds(99));
  EXPECT_TRUE(bench.take(kEmergency).empty());
  bench.advance(milliseconds(1));
  const auto emergencies = bench.take(kEmergency);
  ASSERT_FALSE(emergencies.empty());
  EXPECT_EQ(emergencies[0], frame(kEmergency, {0x30, 0x81, 0x11, 2, 1, 0, 0, 0}));
  EXPECT_EQ(bench.drive().motor().state(), MotorState::coasting);
  EXPECT_EQ(*bench.read(kGuarded, 0x6041, 0) & 0x4FU, 0x08U);
  EXPECT_EQ(bench.drive().state(), NmtState::pre_operational);  // 0x1029:01 = 0
}

TEST_P(Consumer, TheHeartbeatComesBackAndTheFaultStays) {
  OneDrive bench(GetParam(), kGuarded);
  ASSERT_EQ(bench.write(kGuarded, 0x1029, 1, 1, 1), 0U);
  ASSERT_EQ(bench.write(kGuarded, 0x1016, 1, 1U << 16U | 300U, 4), 0U);
  bench.start();
  heartbeat(bench);
  bench.advance(milliseconds(400));
  EXPECT_EQ(bench.drive().state(), NmtState::operational);  // 0x1029:01 = 1
  bench.take(kEmergency);
  heartbeat(bench);
  EXPECT_EQ(bench.take(kEmergency).size(), 1U);
  EXPECT_EQ(*bench.read(kGuarded, 0x6041, 0) & 0x4FU, 0x08U);
  ASSERT_EQ(bench.write(kGuarded, 0x6040, 0, 0x80, 2), 0U);
  EXPECT_EQ(*bench.read(kGuarded, 0x6041, 0) & 0x4FU, 0x40U);
  EXPECT_EQ(bench.drive().motor().output_hz(), 0.0);
}

TEST_P(Consumer, ChangingTheEntryEndsTheError) {
  OneDrive bench(GetParam(), kGuarded);
  ASSERT_EQ(bench.write(kGuarded, 0x1029, 1, 2, 1), 0U);
  ASSERT_EQ(bench.write(kGuarded, 0x1016, 1, 1U << 16U | 300U, 4), 0U);
  heartbeat(bench);
  bench.advance(milliseconds(300));
  EXPECT_EQ(bench.drive().state(), NmtState::stopped);  // 0x1029:01 = 2
  bench.nmt(0x80, kGuarded);
  EXPECT_NE(*bench.read(kGuarded, 0x1001, 0) & 0x10U, 0U);
  ASSERT_EQ(bench.write(kGuarded, 0x1016, 1, 0, 4), 0U);
  EXPECT_EQ(*bench.read(kGuarded, 0x1001, 0) & 0x10U, 0U);
}

INSTANTIATE_TEST_SUITE_P(Kinds, Consumer, ::testing::Values("vacon-opte6", "cia402-velocity"));

TEST(Emergencies, HistoryHoldsTheNewestFirst) {
  OneDrive bench("cia402-velocity", kGuarded);
  bench.drive().fault(0x2310);
  bench.drive().fault(0x3210);
  EXPECT_EQ(bench.read(kGuarded, 0x1003, 0), 2U);
  EXPECT_EQ(bench.read(kGuarded, 0x1003, 1), 0x3210U);
  EXPECT_EQ(bench.read(kGuarded, 0x1003, 2), 0x2310U);
  EXPECT_EQ(bench.write(kGuarded, 0x1003, 0, 1, 1), 0x06090030U);
  EXPECT_EQ(bench.write(kGuarded, 0x1003, 0, 0, 1), 0U);
  EXPECT_EQ(bench.read(kGuarded, 0x1003, 0), 0U);
  EXPECT_EQ(bench.read_abort(kGuarded, 0x1003, 1), 0x08000024U);
}

TEST(Emergencies, CanBeDisabled) {
  OneDrive bench("vacon-opte6", kGuarded);
  EXPECT_EQ(bench.read(kGuarded, 0x1014, 0), kEmergency);
  EXPECT_EQ(bench.write(kGuarded, 0x1014, 0, 0x90, 4), 0x06090030U);
  ASSERT_EQ(bench.write(kGuarded, 0x1014, 0, 0x80000000U | kEmergency, 4), 0U);
  bench.drive().fault(1);
  bench.loop.settle();
  EXPECT_TRUE(bench.take(kEmergency).empty());
}

}  // namespace
}  // namespace simulator
