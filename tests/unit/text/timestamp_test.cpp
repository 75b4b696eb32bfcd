#include "bridges/text/timestamp.h"

#include <gtest/gtest.h>

#include <chrono>

namespace text {
namespace {

using namespace std::chrono;

TEST(Timestamp, IsRfc3339WithMilliseconds) {
  const canopen::WallTime time = sys_days(2026y / January / 2) + 3h + 4min + 5s + 678ms + 999us;
  EXPECT_EQ(timestamp(time), "2026-01-02T03:04:05.678Z");
  EXPECT_EQ(timestamp(canopen::WallTime{}), "1970-01-01T00:00:00.000Z");
}

TEST(Timestamp, ReadsWhatItWrote) {
  const canopen::WallTime time = sys_days(2028y / February / 29) + 23h + 59min + 59s + 1ms;
  EXPECT_EQ(parse_timestamp(timestamp(time)), time);
}

TEST(Timestamp, ReadsNothingElse) {
  for (const char* text : {"", "2026-01-02T03:04:05Z", "2026-01-02 03:04:05.678Z", "2026-02-30T03:04:05.678Z",
                           "2026-13-02T03:04:05.678Z", "2026-01-02T24:04:05.678Z", "2026-01-02T03:60:05.678Z",
                           "2026-01-02T03:04:60.678Z", "2026-01-02T03:04:05.678z", "1969-01-02T03:04:05.678Z",
                           "9999-01-02T03:04:05.678Z", "2026-01-02T03:04:05.678+", "2026-01-02T-3:04:05.678Z"}) {
    EXPECT_FALSE(parse_timestamp(text)) << text;
  }
}

}  // namespace
}  // namespace text
