#include "bridges/mqtt/homecoming.h"

#include <gtest/gtest.h>

#include <optional>

#include "bridges/mqtt/publisher.h"
#include "bridges/mqtt/pulse.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;

class HomecomingTest : public testing::Test {
 protected:
  /// Looks for it as often as it is due, for so long; when it was time to go back.
  std::optional<std::chrono::seconds> time_within(std::chrono::seconds limit, bool reached = true) {
    const auto begun = now_;
    for (; now_ - begun < limit; now_ += 1s) {
      if (homecoming_.is_time(now_)) {
        return std::chrono::duration_cast<std::chrono::seconds>(now_ - begun);
      }
      if (homecoming_.due(now_)) {
        homecoming_.looked(reached, now_);
      }
    }
    return std::nullopt;
  }

  // As it is without further words.
  Homecoming homecoming_{PublisherSettings{}.return_after, PublisherSettings{}.look_interval};
  Homecoming::TimePoint now_{1h};
};

TEST_F(HomecomingTest, IsAfterTenMinutesInWhichTheFirstCouldBeReached) {
  EXPECT_EQ(time_within(1h), 600s);
}

TEST_F(HomecomingTest, IsNeverWhereItCannotBeReached) {
  EXPECT_EQ(time_within(24h, false), std::nullopt);
}

TEST_F(HomecomingTest, OneFailureBeginsItAnew) {
  EXPECT_EQ(time_within(590s), std::nullopt);
  homecoming_.looked(false, now_);
  EXPECT_EQ(time_within(1h), 630s) << "looked for after half a minute";
}

TEST_F(HomecomingTest, TimeInWhichNobodyLookedDoesNotCount) {
  EXPECT_EQ(time_within(300s), std::nullopt);
  now_ += 1h;  // the machine slept
  homecoming_.looked(true, now_);
  EXPECT_FALSE(homecoming_.is_time(now_));
  EXPECT_EQ(time_within(1h), 600s);
}

TEST(Pulse, AsksWhereNothingCameAndWaitsForAnyWord) {
  const Pulse::TimePoint start(1h);
  Pulse pulse;
  pulse.heard(start);
  EXPECT_FALSE(pulse.wants(start + Pulse::kQuiet - 1ms));
  EXPECT_FALSE(pulse.stopped(5s, start + 1h)) << "it was asked nothing";
  ASSERT_TRUE(pulse.wants(start + Pulse::kQuiet));
  pulse.asked(start + Pulse::kQuiet);
  EXPECT_FALSE(pulse.wants(start + 1h)) << "once";
  EXPECT_FALSE(pulse.stopped(5s, start + Pulse::kQuiet + 5s));
  EXPECT_TRUE(pulse.stopped(5s, start + Pulse::kQuiet + 5s + 1ms));
  pulse.heard(start + 4s);
  EXPECT_FALSE(pulse.stopped(5s, start + 1h));
  EXPECT_TRUE(pulse.wants(start + 4s + Pulse::kQuiet));
}

}  // namespace
}  // namespace mqtt
