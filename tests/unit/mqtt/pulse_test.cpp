#include "bridges/mqtt/pulse.h"

#include <gtest/gtest.h>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

TEST(Pulse, AsksWhereNothingCameAndWaitsForAnyWord) {
  const Pulse::TimePoint start(1h);
  constexpr auto kQuiet = 2s;
  Pulse pulse(kQuiet);
  pulse.heard(start);
  EXPECT_FALSE(pulse.wants(start + kQuiet - 1ms));
  EXPECT_FALSE(pulse.stopped(5s, start + 1h)) << "it was asked nothing";
  ASSERT_TRUE(pulse.wants(start + kQuiet));
  pulse.asked(start + kQuiet);
  EXPECT_FALSE(pulse.wants(start + 1h)) << "once";
  EXPECT_FALSE(pulse.stopped(5s, start + kQuiet + 5s - 1ms));
  EXPECT_TRUE(pulse.stopped(5s, start + kQuiet + 5s));
  pulse.heard(start + 4s);
  EXPECT_FALSE(pulse.stopped(5s, start + 1h));
  EXPECT_TRUE(pulse.wants(start + 4s + kQuiet));
}

TEST(Pulse, TellsWhenItIsToBeLookedAt) {
  const Pulse::TimePoint start(1h);
  Pulse pulse(2s);
  pulse.heard(start);
  EXPECT_FALSE(pulse.is_asked());
  EXPECT_EQ(pulse.due(5s), start + 2s);
  pulse.asked(start + 3s);
  EXPECT_TRUE(pulse.is_asked());
  EXPECT_EQ(pulse.due(5s), start + 8s);
  pulse.heard(start + 4s);
  EXPECT_EQ(pulse.due(5s), start + 6s);
}

}  // namespace
}  // namespace mqtt
