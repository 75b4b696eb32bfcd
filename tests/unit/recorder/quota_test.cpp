#include "bridges/recorder/quota.h"

#include <gtest/gtest.h>

#include <chrono>

#include "tests/unit/recorder/moment.h"

namespace recorder {
namespace {

using namespace std::chrono_literals;

TEST(Quota, AllowsTenAnHourAndTellsTheFirstRefusal) {
  Quota quota;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(quota.take("pump1", moment(i * 1min)).allowed);
  }
  const Quota::Verdict first = quota.take("pump1", moment(10min));
  EXPECT_FALSE(first.allowed);
  EXPECT_TRUE(first.first_refusal);
  const Quota::Verdict second = quota.take("pump1", moment(59min));
  EXPECT_FALSE(second.allowed);
  EXPECT_FALSE(second.first_refusal);
}

TEST(Quota, GivesOneBackWhenItsHourIsOver) {
  Quota quota;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(quota.take("pump1", moment(i * 1min)).allowed);
  }
  ASSERT_FALSE(quota.take("pump1", moment(1h - 1ms)).allowed);
  ASSERT_FALSE(quota.take("pump1", moment(1h - 1ms)).allowed);
  const Quota::Verdict again = quota.take("pump1", moment(1h));
  EXPECT_TRUE(again.allowed);
  EXPECT_EQ(again.refused_before, 2U);
  EXPECT_TRUE(quota.take("pump1", moment(1h)).first_refusal);
}

TEST(Quota, CountsEachSubjectByItself) {
  Quota quota;
  for (int i = 0; i < 11; ++i) {
    static_cast<void>(quota.take("pump1", moment(0s)));
  }
  EXPECT_TRUE(quota.take("pump2", moment(0s)).allowed);
}

}  // namespace
}  // namespace recorder
