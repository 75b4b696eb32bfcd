#include "bridges/recorder/frame_ring.h"

#include <gtest/gtest.h>

#include <chrono>
#include <vector>

#include "tests/support/frame.h"
#include "tests/unit/recorder/moment.h"

namespace recorder {
namespace {

using namespace std::chrono_literals;

void push(FrameRing& ring, std::uint32_t number) {
  canopen::Received received{support::frame(0x185), moment(number * 1ms), {}};
  received.frame.id = number;
  ring.on_frame(received, canopen::FrameOrigin::others);
}

std::vector<std::uint32_t> numbers(const FrameSlice& slice) {
  std::vector<std::uint32_t> numbers;
  slice.each([&](const KeptFrame& frame) { numbers.push_back(frame.id); });
  return numbers;
}

// 10 s of a frame each millisecond are kept, in whole chunks.
class FrameRingTest : public ::testing::Test {
 protected:
  void fill(std::uint32_t until) {
    for (; next_ < until; ++next_) {
      push(ring_, next_);
    }
  }
  FrameRing ring_{10s, 100'000};
  std::uint32_t next_ = 0;
};

TEST_F(FrameRingTest, GivesWhatCameBetweenTwoMomentsInOrder) {
  fill(5000);
  const auto found = numbers(ring_.slice(moment(1999ms), moment(4100ms)));
  ASSERT_EQ(found.size(), 2102U);
  EXPECT_EQ(found.front(), 1999U);
  EXPECT_EQ(found.back(), 4100U);
  EXPECT_TRUE(std::ranges::is_sorted(found));
}

TEST_F(FrameRingTest, AnEmptyOneHasNothing) {
  EXPECT_TRUE(numbers(ring_.slice(moment(0s), moment(1h))).empty());
  EXPECT_EQ(ring_.memory(), 0U);
}

TEST_F(FrameRingTest, ForgetsWhatIsOlderThanItsTimeAndNothingElse) {
  fill(60'000);
  const FrameSlice slice = ring_.slice(moment(49999ms), moment(1h));
  EXPECT_EQ(numbers(slice).size(), 10001U);
  EXPECT_FALSE(slice.cut);
  EXPECT_LE(ring_.memory(), 7 * sizeof(FrameChunk));
}

TEST_F(FrameRingTest, HoldsWhatIsWantedUntilItIsReleased) {
  fill(20'000);
  ring_.hold(moment(10s));
  fill(40'000);
  const FrameSlice held = ring_.slice(moment(10s), moment(1h));
  EXPECT_EQ(numbers(held).size(), 30'000U);
  ring_.release();
  fill(60'000);
  EXPECT_LE(ring_.memory(), 7 * sizeof(FrameChunk));
  EXPECT_EQ(numbers(held).size(), 30'000U) << "what was taken is still there";
}

TEST_F(FrameRingTest, TakesNoMoreMemoryThanItMay) {
  FrameRing ring(10s, 4096);
  for (std::uint32_t i = 0; i < 9000; ++i) {
    push(ring, i);
  }
  EXPECT_LE(ring.memory(), 3 * sizeof(FrameChunk));
  const FrameSlice slice = ring.slice(moment(0s), moment(1h));
  EXPECT_TRUE(slice.cut);
  EXPECT_EQ(numbers(slice).back(), 8999U);
  EXPECT_GE(numbers(slice).size(), 4096U);
  EXPECT_FALSE(ring.slice(moment(8s), moment(1h)).cut) << "of these none is missing";
}

TEST_F(FrameRingTest, WhatCameBehindASliceIsNotInIt) {
  fill(100);
  const FrameSlice slice = ring_.slice(moment(0s), canopen::TimePoint::max());
  fill(3000);
  EXPECT_EQ(numbers(slice).size(), 100U);
}

TEST(MostFrames, IsWhatFullFramesOfTheBitRateCanBe) {
  EXPECT_EQ(most_frames(1'000'000, 10s), 90'091U);
  EXPECT_EQ(most_frames(std::nullopt, 10s), 90'091U);
  EXPECT_EQ(most_frames(125'000, 15s), 16'892U);
}

}  // namespace
}  // namespace recorder
