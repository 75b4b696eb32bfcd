#include "canopen/survey/burst_meter.h"

#include <gtest/gtest.h>

namespace canopen {
namespace {

using namespace std::chrono_literals;

class BurstMeterTest : public testing::Test {
 protected:
  BurstMeterTest() { meter_.set_bitrate(125'000); }
  void hear(Duration after) {
    moment_.at += after;
    meter_.hear(moment_);
  }
  [[nodiscard]] Burst told() const { return meter_.of_day(moment_.hour).value(); }

  BurstMeter meter_;
  Moment moment_{.at = TimePoint(1h), .hour = 1, .unbroken = 1};
};

TEST_F(BurstMeterTest, CountsFramesThatFollowEachOther) {
  hear(0ms);
  for (int i = 0; i < 9; ++i) {
    hear(1ms);  // A frame of 8 bytes takes up to 1.08 ms.
  }
  for (int i = 0; i < 50; ++i) {
    hear(5ms);
  }
  hear(1ms);
  EXPECT_EQ(told().frames, 10U);
  EXPECT_NEAR(static_cast<double>(told().time.count()), 9e6, 2e3);
}

TEST_F(BurstMeterTest, TheOneThatGoesOnCounts) {
  hear(0ms);
  hear(1ms);
  hear(1ms);
  EXPECT_EQ(told().frames, 3U);
  EXPECT_EQ(told().time, 2ms);
}

TEST_F(BurstMeterTest, AFasterBusHasShorterPauses) {
  meter_.set_bitrate(1'000'000);
  hear(0ms);
  hear(1ms);
  hear(1ms);
  EXPECT_EQ(told().frames, 1U);
  hear(130us);
  hear(130us);
  EXPECT_EQ(told().frames, 3U);
}

TEST_F(BurstMeterTest, LostFramesEndIt) {
  hear(0ms);
  hear(1ms);
  ++moment_.unbroken;
  hear(1ms);
  EXPECT_EQ(told().frames, 2U);
}

TEST_F(BurstMeterTest, WithoutABitRateOrAFrameThereIsNone) {
  EXPECT_FALSE(meter_.of_day(1));
  BurstMeter unknown;
  unknown.hear(moment_);
  unknown.hear(moment_);
  EXPECT_FALSE(unknown.of_day(1));
}

TEST_F(BurstMeterTest, OneOfAnotherBitRateIsForgotten) {
  hear(0ms);
  hear(1ms);
  hear(1s);
  hear(1ms);
  hear(1ms);
  meter_.set_bitrate(500'000);
  EXPECT_EQ(told().frames, 2U);
  EXPECT_NEAR(static_cast<double>(told().time.count()), 1e6, 2e3);
}

TEST_F(BurstMeterTest, TheLastOneOfASilentBusIsForgottenAfterADayToo) {
  hear(0ms);
  hear(1ms);
  meter_.settle(moment_.at + 500ms, 1);
  hear(1ms);
  EXPECT_EQ(told().frames, 3U) << "it goes on";
  meter_.settle(moment_.at + 2s, 1);
  meter_.settle(moment_.at + 1h, 2);
  EXPECT_EQ(meter_.of_day(25)->frames, 3U);
  EXPECT_FALSE(meter_.of_day(26));
}

TEST_F(BurstMeterTest, IsForgottenAfterADay) {
  hear(0ms);
  hear(1ms);
  hear(1ms);
  hear(1s);
  for (moment_.hour = 2; moment_.hour <= 26; ++moment_.hour) {
    hear(1s);
    ASSERT_EQ(told().frames, moment_.hour <= 25 ? 3U : 1U) << moment_.hour;
  }
}

}  // namespace
}  // namespace canopen
