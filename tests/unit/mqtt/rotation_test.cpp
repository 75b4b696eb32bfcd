#include "bridges/mqtt/rotation.h"

#include <gtest/gtest.h>

#include <vector>

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using Outcome = Rotation::Outcome;

class RotationTest : public testing::Test {
 protected:
  /// The turn of the broker ends like this; the pause passes.
  Rotation::Milliseconds end(Outcome outcome, Rotation& rotation) {
    const auto pause = rotation.next(outcome, now_);
    now_ += pause;
    return pause;
  }

  static constexpr Rotation::Pauses kPauses{1000ms, 5000ms, 60000ms};
  Rotation::TimePoint now_{1h};
};

TEST_F(RotationTest, PausesOfOneBrokerDoubleUpToTheLongestWithBoundedJitter) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Rotation rotation(1, kPauses, seed);
    auto whole = 1000ms;
    for (int i = 0; i < 100; ++i) {
      const auto pause = end(Outcome::none, rotation);
      EXPECT_LE(pause, whole);
      EXPECT_GE(pause, whole / 2);
      EXPECT_EQ(rotation.at(), 0U);
      whole = std::min(whole * 2, 5000ms);
    }
    EXPECT_LE(end(Outcome::broke, rotation), 1000ms) << "it stood";
  }
}

TEST_F(RotationTest, PausesDifferFromGatewayToGateway) {
  Rotation one(1, kPauses, 1);
  Rotation other(1, kPauses, 2);
  int same = 0;
  for (int i = 0; i < 10; ++i) {
    same += one.next(Outcome::none, now_) == other.next(Outcome::none, now_) ? 1 : 0;
  }
  EXPECT_LT(same, 10);
}

TEST_F(RotationTest, EachIsTriedInOrderAtOnceAndThenAllAgainAfterAPause) {
  Rotation rotation(3, kPauses, 1);
  for (int round = 0; round < 4; ++round) {
    EXPECT_EQ(rotation.is_first_round(), round == 0);
    EXPECT_EQ(rotation.at(), 0U);
    EXPECT_EQ(end(Outcome::none, rotation), 0ms);
    EXPECT_EQ(rotation.at(), 1U);
    EXPECT_EQ(end(Outcome::none, rotation), 0ms);
    EXPECT_EQ(rotation.at(), 2U);
    EXPECT_GE(end(Outcome::none, rotation), 500ms);
  }
  (void)end(Outcome::brief, rotation);
  EXPECT_TRUE(rotation.is_first_round()) << "there was a connection";
}

TEST_F(RotationTest, AConnectionThatBreaksIsMadeAgainToTheSameBroker) {
  Rotation rotation(2, kPauses, 1);
  (void)end(Outcome::none, rotation);
  ASSERT_EQ(rotation.at(), 1U);
  for (int i = 0; i < 10; ++i) {
    now_ += 2min;
    EXPECT_LE(end(Outcome::broke, rotation), 1000ms);
    EXPECT_EQ(rotation.at(), 1U);
  }
  EXPECT_EQ(end(Outcome::none, rotation), 0ms) << "it is gone";
  EXPECT_EQ(rotation.at(), 0U);
  EXPECT_GE(end(Outcome::none, rotation), 500ms) << "each was tried";
  EXPECT_EQ(rotation.at(), 0U) << "in order";
}

TEST_F(RotationTest, OneThatFallsSilentIsFollowedByTheNextAtOnce) {
  Rotation rotation(2, kPauses, 1);
  EXPECT_EQ(end(Outcome::silent, rotation), 0ms);
  EXPECT_EQ(rotation.at(), 1U);
  EXPECT_GE(end(Outcome::none, rotation), 500ms) << "the first was tried";
  EXPECT_EQ(rotation.at(), 0U);
  Rotation only(1, kPauses, 1);
  EXPECT_GE(end(Outcome::silent, only), 500ms);
  EXPECT_EQ(only.at(), 0U);
}

TEST_F(RotationTest, OneThatNeverHoldsIsLeft) {
  Rotation rotation(2, kPauses, 1);
  for (int i = 1; i < Rotation::kBrief; ++i) {
    EXPECT_GE(end(Outcome::brief, rotation), 500ms);
    EXPECT_EQ(rotation.at(), 0U);
  }
  EXPECT_EQ(end(Outcome::brief, rotation), 0ms);
  EXPECT_EQ(rotation.at(), 1U);
  (void)end(Outcome::brief, rotation);
  EXPECT_EQ(rotation.at(), 1U) << "the next one counts by itself";
}

TEST_F(RotationTest, OneThatBreaksAgainAndAgainIsLeftThoughEachConnectionHeld) {
  Rotation rotation(2, kPauses, 1);
  for (std::size_t i = 1; i < Rotation::kEnds; ++i) {
    now_ += 12s;
    EXPECT_GT(end(Outcome::broke, rotation), 0ms);
    EXPECT_EQ(rotation.at(), 0U);
  }
  now_ += 12s;
  EXPECT_EQ(end(Outcome::broke, rotation), 0ms);
  EXPECT_EQ(rotation.at(), 1U);
  EXPECT_GT(end(Outcome::broke, rotation), 0ms) << "the next one counts by itself";
  EXPECT_EQ(rotation.at(), 1U);
  Rotation only(1, kPauses, 1);
  for (int i = 0; i < 20; ++i) {
    EXPECT_GT(end(Outcome::broke, only), 0ms);
  }
}

TEST_F(RotationTest, ARefusalBarsThatBrokerAlone) {
  Rotation rotation(2, kPauses, 1);
  EXPECT_EQ(end(Outcome::refused, rotation), 0ms) << "the second is used at once";
  EXPECT_EQ(rotation.at(), 1U);
  const auto begun = now_;
  while (rotation.at() == 1) {
    EXPECT_LE(end(Outcome::none, rotation), 5000ms);
  }
  EXPECT_GE(now_ - begun, 60s);
  EXPECT_LE(now_ - begun, 66s);
}

TEST_F(RotationTest, WhereEachRefusesTheFirstWhoseTimeIsOverIsTried) {
  Rotation rotation(2, kPauses, 1);
  EXPECT_EQ(end(Outcome::refused, rotation), 0ms);
  now_ += 20s;  // the second's turn
  EXPECT_EQ(end(Outcome::refused, rotation), 40s);
  EXPECT_EQ(rotation.at(), 0U);
  EXPECT_EQ(end(Outcome::refused, rotation), 20s);
  EXPECT_EQ(rotation.at(), 1U);
  Rotation only(1, kPauses, 1);
  EXPECT_EQ(end(Outcome::refused, only), 60s);
}

// With the next broker the two gateways would lose sight of each other.
TEST_F(RotationTest, AfterATakeOverItComesBackToTheSameBroker) {
  Rotation rotation(2, kPauses, 1);
  EXPECT_EQ(end(Outcome::taken_over, rotation), 60s);
  EXPECT_EQ(rotation.at(), 0U);
}

TEST_F(RotationTest, ABrokerIsLeftForTheFirstAndFoundAgainWhereThatFails) {
  for (const Outcome failure : {Outcome::none, Outcome::refused}) {
    Rotation rotation(3, kPauses, 1);
    (void)end(Outcome::none, rotation);
    (void)end(Outcome::none, rotation);
    ASSERT_EQ(rotation.at(), 2U);
    EXPECT_EQ(end(Outcome::left, rotation), 0ms);
    EXPECT_EQ(rotation.at(), 0U);
    EXPECT_EQ(end(failure, rotation), 0ms);
    EXPECT_EQ(rotation.at(), 2U) << "not by way of the second, which may be dead";
    EXPECT_EQ(end(Outcome::none, rotation), 0ms);
    EXPECT_EQ(rotation.at(), 1U) << "if it is gone, too";
  }
}

}  // namespace
}  // namespace mqtt
