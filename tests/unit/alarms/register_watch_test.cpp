// When 0x1001 is read while an error is undecided.

#include "bridges/alarms/register_watch.h"

#include <gtest/gtest.h>

#include <vector>

namespace alarms {
namespace {

using namespace std::chrono_literals;
using canopen::Duration;
using canopen::TimePoint;

constexpr TimePoint kStart{std::chrono::hours(1)};

/// Reads, each answered at once, within `until` of kStart.
std::vector<Duration> readings(RegisterWatch& watch, TimePoint since, Duration until) {
  std::vector<Duration> at;
  for (TimePoint next = watch.next(since); next <= kStart + until; next = watch.next(since)) {
    at.push_back(next - kStart);
    watch.on_read(next, true);
  }
  return at;
}

TEST(RegisterWatch, AsksForNothingWhereNothingIsUndecided) {
  RegisterWatch watch;
  EXPECT_EQ(watch.next(std::nullopt), canopen::kNever);
  watch.on_emergency(kStart);
  EXPECT_EQ(watch.next(std::nullopt), canopen::kNever);
}

TEST(RegisterWatch, ReadsEverySecondForAMinuteThenEveryTen) {
  RegisterWatch watch;
  const std::vector<Duration> at = readings(watch, kStart, 100s);
  ASSERT_EQ(at.size(), 65U);
  EXPECT_EQ(at.front(), 0s) << "what the signal told is asked for at once";
  EXPECT_EQ(at[1], 1s);
  EXPECT_EQ(at[60], 60s);
  EXPECT_EQ(at[61], 70s);
  EXPECT_EQ(at[64], 100s);
}

TEST(RegisterWatch, ADriveThatDoesNotAnswerIsAskedSeldom) {
  RegisterWatch watch;
  watch.on_read(kStart, false);
  EXPECT_EQ(watch.next(kStart), kStart + 1s) << "a stop may have cut it short";
  watch.on_read(kStart + 1s, false);
  EXPECT_EQ(watch.next(kStart), kStart + 11s);
  watch.on_emergency(kStart + 2s);
  EXPECT_EQ(watch.next(kStart), kStart + 11s) << "it may chatter, and 0x1001 stay silent";
  watch.on_read(kStart + 11s, true);
  EXPECT_EQ(watch.next(kStart), kStart + 12s) << "it answers again";
  watch.on_read(kStart + 12s, false);
  watch.on_read(kStart + 13s, false);
  EXPECT_EQ(watch.next(kStart), kStart + 23s);
  watch.forget_silence();
  EXPECT_EQ(watch.next(kStart), kStart + 14s) << "it is another life";
}

TEST(RegisterWatch, TheFirstReadingAfterAnEmergencyWaitsASecond) {
  RegisterWatch watch;
  watch.on_emergency(kStart);
  EXPECT_EQ(watch.next(kStart), kStart + 1s);
}

TEST(RegisterWatch, TheMinuteStartsAgainWithAnEmergency) {
  RegisterWatch watch;
  EXPECT_EQ(readings(watch, kStart, 85s).back(), 80s);
  watch.on_emergency(kStart + 85s);
  EXPECT_EQ(readings(watch, kStart, 87s), (std::vector<Duration>{86s, 87s}));
  EXPECT_EQ(readings(watch, kStart, 170s).back(), 165s) << "145, 155, 165";
}

TEST(RegisterWatch, TheMinuteStartsAgainWithAFurtherUndecidedError) {
  RegisterWatch watch;
  EXPECT_EQ(readings(watch, kStart, 85s).back(), 80s);
  EXPECT_EQ(readings(watch, kStart + 85s, 87s), (std::vector<Duration>{85s, 86s, 87s}));
}

TEST(RegisterWatch, EmergenciesThatChatterDoNotPutItOff) {
  RegisterWatch watch;
  int read = 0;
  for (Duration at = 0s; at < 10s; at += 10ms) {
    watch.on_emergency(kStart + at);
    if (watch.next(kStart) <= kStart + at) {
      watch.on_read(kStart + at, true);
      ++read;
    }
  }
  EXPECT_GE(read, 8);
  EXPECT_LE(read, 10);
}

TEST(RegisterWatch, ASlowDriveIsAskedASecondAfterItsAnswer) {
  RegisterWatch watch;
  watch.on_read(kStart + 5s, true);
  EXPECT_EQ(watch.next(kStart), kStart + 6s);
}

}  // namespace
}  // namespace alarms
