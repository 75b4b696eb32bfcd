#include "bridges/modbus/arrivals.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>

namespace {

using modbus::Arrivals;
using std::chrono::seconds;

constexpr canopen::TimePoint kBegin = canopen::TimePoint{} + std::chrono::hours(1);

canopen::TimePoint at(int second) {
  return kBegin + seconds(second);
}

class ArrivalsTest : public testing::Test {
 protected:
  void expect(std::uint64_t position, int earliest, int latest) {
    const Arrivals::Between came = arrivals_.of(position);
    EXPECT_EQ(came.earliest, at(earliest)) << position;
    EXPECT_EQ(came.latest, at(latest)) << position;
    arrivals_.forget(position);
  }
  Arrivals arrivals_{kBegin};
};

TEST_F(ArrivalsTest, WhatIsWaitedForCameJustNow) {
  arrivals_.on_look(0, at(1));
  arrivals_.on_awaited(12, at(9));
  expect(12, 9, 9);
}

TEST_F(ArrivalsTest, WhatIsFoundCameSinceTheLastLook) {
  arrivals_.on_awaited(12, at(1));
  arrivals_.on_look(24, at(4));
  arrivals_.on_look(24, at(5));
  arrivals_.on_look(30, at(7));
  arrivals_.on_awaited(36, at(9));
  expect(12, 1, 1);
  expect(24, 1, 4);
  expect(26, 5, 7);
  expect(30, 5, 7);
  expect(36, 9, 9);
}

TEST_F(ArrivalsTest, WhatIsReadLaterIsAsOldAsWhenItWasFound) {
  arrivals_.on_awaited(12, at(1));
  arrivals_.on_look(36, at(4));
  arrivals_.on_awaited(24, at(9));
  EXPECT_EQ(arrivals_.of(36).latest, at(4));
  expect(24, 1, 4);
  arrivals_.on_awaited(36, at(10));
  expect(36, 1, 4);
}

TEST_F(ArrivalsTest, OfMoreThanItKeepsTheLastAreLessSure) {
  for (int i = 1; i <= 40; ++i) {
    arrivals_.on_look(static_cast<std::uint64_t>(i), at(i));
  }
  expect(1, 0, 1);
  expect(15, 14, 15);
  expect(16, 15, 40);
  expect(40, 15, 40);
  arrivals_.on_look(41, at(41));
  expect(41, 40, 41);
}

// A SCADA reads for hours before it writes.
TEST_F(ArrivalsTest, WhatWasServedTakesNoRoom) {
  for (int i = 1; i <= 100; ++i) {
    arrivals_.on_awaited(static_cast<std::uint64_t>(i) * 12, at(i));
    arrivals_.forget(static_cast<std::uint64_t>(i) * 12);
  }
  arrivals_.on_awaited(101 * 12, at(200));
  expect(101 * 12, 200, 200);
}

TEST_F(ArrivalsTest, WhatComesBehindWhatWasServedIsKept) {
  arrivals_.on_awaited(12, at(1));
  arrivals_.on_look(36, at(4));
  arrivals_.forget(24);
  expect(36, 1, 4);
}

}  // namespace
