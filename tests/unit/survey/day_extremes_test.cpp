#include "canopen/survey/day_extremes.h"

#include <gtest/gtest.h>

namespace canopen {
namespace {

constexpr std::uint32_t kNow = 1000;

TEST(DayExtremes, HasNothingToTellBeforeTheFirst) {
  EXPECT_FALSE(DayExtremes().of_day(0));
  EXPECT_FALSE(DayExtremes().of_day(kNow));
}

TEST(DayExtremes, HoldsTheLeastAndTheMost) {
  DayExtremes figure;
  for (const std::uint32_t value : {7U, 3U, 9U, 5U}) {
    figure.add(value, kNow);
  }
  EXPECT_EQ(figure.of_day(kNow), (Extremes{3, 9}));
}

TEST(DayExtremes, AnHourIsForgottenAfterTwentyFourFurtherOnes) {
  DayExtremes figure;
  figure.add(100, kNow);
  figure.add(0, kNow);
  for (std::uint32_t hour = 1; hour <= 24; ++hour) {
    figure.add(50, kNow + hour);
    ASSERT_EQ(figure.of_day(kNow + hour), (Extremes{0, 100})) << hour;
  }
  EXPECT_EQ(figure.of_day(kNow + 25), (Extremes{50, 50})) << "nothing needs to be added for it to go";
  figure.add(51, kNow + 25);
  EXPECT_EQ(figure.of_day(kNow + 25), (Extremes{50, 51}));
}

TEST(DayExtremes, APauseOfDaysLeavesNothing) {
  DayExtremes figure;
  figure.add(100, kNow);
  EXPECT_FALSE(figure.of_day(kNow + 25));
  EXPECT_FALSE(figure.of_day(kNow + 1000));
  figure.add(1, kNow + 1000);
  EXPECT_EQ(figure.of_day(kNow + 1000), (Extremes{1, 1}));
}

}  // namespace
}  // namespace canopen
