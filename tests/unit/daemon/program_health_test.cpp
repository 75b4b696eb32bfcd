#include "daemon/program_health.h"

#include <gtest/gtest.h>

#include "tests/support/hand_driven_loop.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;

TEST(ProgramHealth, IsThatOfThisProcess) {
  support::HandDrivenLoop loop;
  const canopen::TimePoint started = canopen::Clock::now();
  loop.advance(90s, 30s);
  const process::ProgramHealth health = program_health(started, "ab12");
  EXPECT_EQ(health.uptime, 90s);
  EXPECT_EQ(health.journal, "ab12");
  EXPECT_TRUE(health.clock_set);
  EXPECT_GT(health.memory, 1'000'000U) << "bytes, not pages";
  EXPECT_LT(health.memory, 100'000'000'000U);
}

TEST(ProgramHealth, KnowsAClockThatNobodySet) {
  EXPECT_TRUE(is_unset(canopen::WallTime{}));
  EXPECT_TRUE(is_unset(std::chrono::sys_days(std::chrono::year(2023) / 2 / 15)));
  EXPECT_FALSE(is_unset(std::chrono::sys_days(std::chrono::year(2026) / 1 / 2)));
}

}  // namespace
}  // namespace gateway
