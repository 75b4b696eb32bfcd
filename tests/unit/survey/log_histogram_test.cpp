#include "canopen/survey/log_histogram.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace canopen {
namespace {

using namespace std::chrono_literals;

TEST(LogHistogram, HasNothingToTellBeforeTheFirst) {
  EXPECT_EQ(LogHistogram().percentiles(), LogHistogram::Percentiles{});
}

TEST(LogHistogram, IsOffByNoMoreThanItSays) {
  for (Duration value = 10us; value < 137s; value += value / 97) {
    LogHistogram histogram;
    histogram.add(value);
    const Duration off = std::chrono::abs(histogram.percentiles().p50 - value);
    ASSERT_LE(off, value / 32 + 1us) << value.count();
  }
  for (Duration value = 0us; value < 20us; value += 100ns) {
    LogHistogram histogram;
    histogram.add(value);
    ASSERT_LE(std::chrono::abs(histogram.percentiles().p50 - value), value / 32 + 600ns) << value.count();
  }
}

TEST(LogHistogram, TellsMedianAndTheRareLongOnes) {
  LogHistogram histogram;
  for (int i = 0; i < 980; ++i) {
    histogram.add(100ms);
  }
  for (int i = 0; i < 20; ++i) {
    histogram.add(900ms);
  }
  const LogHistogram::Percentiles told = histogram.percentiles();
  EXPECT_EQ(told.count, 1000U);
  EXPECT_NEAR(static_cast<double>(told.p50.count()), 100e6, 100e6 / 32);
  EXPECT_NEAR(static_cast<double>(told.p99.count()), 900e6, 900e6 / 32);
}

TEST(LogHistogram, OneInTwoHundredIsBelowTheNinetyNinth) {
  LogHistogram histogram;
  for (int i = 0; i < 1000; ++i) {
    histogram.add(i % 200 == 0 ? 2s : 10ms);
  }
  EXPECT_LT(histogram.percentiles().p99, 11ms);
}

TEST(LogHistogram, WhatIsBeyondItsScaleCountsAtItsEnds) {
  LogHistogram histogram;
  histogram.add(-5ms);
  EXPECT_LT(histogram.percentiles().p50, 2us);
  for (int i = 0; i < 9; ++i) {
    histogram.add(24h);
  }
  EXPECT_GT(histogram.percentiles().p50, 120s);
  EXPECT_LE(histogram.percentiles().p50, 138s);
}

TEST(LogHistogram, ForgetsWhatWasLongAgo) {
  LogHistogram histogram;
  for (int i = 0; i < 100'000; ++i) {
    histogram.add(500ms);
  }
  EXPECT_LE(histogram.percentiles().count, LogHistogram::kForgetAt);
  for (std::uint32_t i = 0; i < LogHistogram::kForgetAt; ++i) {
    histogram.add(20ms);
  }
  EXPECT_LT(histogram.percentiles().p50, 22ms);
  for (std::uint32_t i = 0; i < 8 * LogHistogram::kForgetAt; ++i) {
    histogram.add(20ms);
  }
  EXPECT_LT(histogram.percentiles().p99, 22ms) << "not one of the old ones is left";
}

}  // namespace
}  // namespace canopen
