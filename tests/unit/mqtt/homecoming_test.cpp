#include "bridges/mqtt/homecoming.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "bridges/mqtt/publisher.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using Step = Homecoming::Step;

class HomecomingTest : public testing::Test {
 protected:
  /// Does what is due for so long; when the first trial was due, which is not made.
  std::optional<std::chrono::seconds> trial_within(std::chrono::seconds limit, bool reached = true) {
    const auto begun = now_;
    for (; now_ - begun < limit; now_ += 1s) {
      const Step step = homecoming_.due(now_);
      if (step == Step::try_it) {
        return std::chrono::duration_cast<std::chrono::seconds>(now_ - begun);
      }
      if (step == Step::look) {
        homecoming_.looked(reached, now_);
      }
    }
    return std::nullopt;
  }
  /// The first takes a trial, is gone back to, and its turn ends like this.
  void go_back(Homecoming::Milliseconds stood, bool stays = false) {
    homecoming_.tried(true, now_);
    EXPECT_TRUE(homecoming_.may_go());
    homecoming_.went();
    now_ += stood;
    homecoming_.ended(stood, stays, now_);
  }

  // As it is without further words.
  Homecoming homecoming_{PublisherSettings{}.return_after, PublisherSettings{}.look_interval};
  Homecoming::TimePoint now_{1h};
};

TEST_F(HomecomingTest, IsTriedAfterTenMinutesInWhichTheFirstCouldBeReached) {
  EXPECT_EQ(trial_within(1h), 600s);
  EXPECT_FALSE(homecoming_.may_go()) << "to be reached is not enough";
  homecoming_.tried(true, now_);
  EXPECT_TRUE(homecoming_.may_go());
}

TEST_F(HomecomingTest, IsNeverWhereItCannotBeReached) {
  EXPECT_EQ(trial_within(24h, false), std::nullopt);
}

TEST_F(HomecomingTest, OneFailureBeginsItAnew) {
  EXPECT_EQ(trial_within(590s), std::nullopt);
  homecoming_.looked(false, now_);
  EXPECT_EQ(trial_within(1h), 630s) << "looked for after half a minute";
}

TEST_F(HomecomingTest, TimeInWhichNobodyLookedDoesNotCount) {
  EXPECT_EQ(trial_within(300s), std::nullopt);
  now_ += 1h;  // the machine slept
  homecoming_.looked(true, now_);
  EXPECT_EQ(trial_within(1h), 600s);
}

TEST_F(HomecomingTest, EachTrialThatFailsDoublesTheTimeUpToFourHours) {
  std::chrono::seconds expected = 600s;
  for (int i = 0; i < 8; ++i) {
    const auto waited = trial_within(24h);
    ASSERT_TRUE(waited);
    EXPECT_GE(*waited, expected);
    EXPECT_LE(*waited, expected + Homecoming::kRarest + 60s);
    homecoming_.tried(false, now_);
    EXPECT_FALSE(homecoming_.may_go());
    expected = std::min<std::chrono::seconds>(2 * expected, 4h);
  }
}

// Each look is a line in that broker's log.
TEST_F(HomecomingTest, IsLookedForMoreRarelyTheMoreTrialsFailed) {
  for (const auto interval : {30s, 60s, 120s, 240s, 300s, 300s}) {
    homecoming_.looked(true, now_);
    EXPECT_EQ(homecoming_.due(now_ + interval - 1s), Step::none) << interval.count();
    EXPECT_NE(homecoming_.due(now_ + interval), Step::none) << interval.count();
    homecoming_.tried(false, now_);
  }
}

TEST_F(HomecomingTest, EachReturnThatFailsDoublesItUntilTheFirstHeld) {
  ASSERT_TRUE(trial_within(1h));
  go_back(0ms);
  EXPECT_GE(trial_within(24h).value_or(0s), 1200s);
  go_back(5min);  // and broke again and again
  EXPECT_GE(trial_within(24h).value_or(0s), 2400s);
  go_back(10min);
  EXPECT_LE(trial_within(24h).value_or(24h), 660s) << "it was in use for long enough";
}

TEST_F(HomecomingTest, ABreakAtTheFirstIsNoFailureWhileItIsItsTurn) {
  ASSERT_TRUE(trial_within(1h));
  go_back(1min, true);
  EXPECT_FALSE(homecoming_.is_arriving()) << "from now on it hurries";
  homecoming_.ended(1h, false, now_);
  EXPECT_LE(trial_within(24h).value_or(24h), 660s);
}

TEST_F(HomecomingTest, ATrialCountsUntilALookFails) {
  ASSERT_TRUE(trial_within(1h));
  homecoming_.tried(true, now_);
  EXPECT_EQ(trial_within(570s), std::nullopt);
  EXPECT_TRUE(homecoming_.may_go()) << "something keeps the gateway where it is";
  EXPECT_TRUE(trial_within(61s)) << "after 10 min it is tried again: somebody may have changed the password";
  homecoming_.looked(false, now_);
  EXPECT_FALSE(homecoming_.may_go());
}

}  // namespace
}  // namespace mqtt
