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
  EXPECT_FALSE(pulse.stopped(5s, start + kQuiet + 5s));
  EXPECT_TRUE(pulse.stopped(5s, start + kQuiet + 5s + 1ms));
  pulse.heard(start + 4s);
  EXPECT_FALSE(pulse.stopped(5s, start + 1h));
  EXPECT_TRUE(pulse.wants(start + 4s + kQuiet));
}

}  // namespace
}  // namespace mqtt
