#include "bridges/journal/repeats.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace journal {
namespace {

using std::chrono::seconds;

Ended ended(int second, const std::string& id) {
  using namespace std::chrono;
  return {sys_days(year(2026) / January / 2) + seconds(second), canopen::TimePoint(seconds(second)),
          R"("drive":"pump1","outcome":"ok")", R"("id":")" + id + '"'};
}

TEST(JournalRepeats, TheFirstHasItsLineAtOnceAndTheRestOfTheMinuteIsOneLine) {
  Repeats repeats;
  const auto first = repeats.add("kind", ended(0, "a"));
  ASSERT_TRUE(first);
  EXPECT_EQ(first->members, R"("phase":"done","drive":"pump1","outcome":"ok","id":"a")");
  EXPECT_EQ(repeats.due(), canopen::TimePoint(seconds(60)));
  EXPECT_FALSE(repeats.add("kind", ended(1, "b")));
  EXPECT_FALSE(repeats.add("kind", ended(2, "c")));
  EXPECT_FALSE(repeats.add("kind", ended(3, "d")));
  EXPECT_TRUE(repeats.take_due(canopen::TimePoint(seconds(59))).empty());
  const auto lines = repeats.take_due(canopen::TimePoint(seconds(60)));
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].members,
            R"("phase":"done","drive":"pump1","outcome":"ok","count":3,)"
            R"("first":{"ts":"2026-01-02T00:00:01.000Z","id":"b"},"last":{"ts":"2026-01-02T00:00:03.000Z","id":"d"})");
  EXPECT_EQ(lines[0].at, canopen::TimePoint(seconds(3)));
}

TEST(JournalRepeats, GoOnByMinutesWhileThereAreSome) {
  Repeats repeats;
  ASSERT_TRUE(repeats.add("kind", ended(0, "a")));
  EXPECT_FALSE(repeats.add("kind", ended(1, "b")));
  EXPECT_EQ(repeats.take_due(canopen::TimePoint(seconds(60)))[0].members,
            R"("phase":"done","drive":"pump1","outcome":"ok","id":"b")")
      << "one alone is told like any other";
  EXPECT_FALSE(repeats.add("kind", ended(61, "c"))) << "one line a minute";
  EXPECT_EQ(repeats.take_due(canopen::TimePoint(seconds(120))).size(), 1U);
  EXPECT_TRUE(repeats.take_due(canopen::TimePoint(seconds(180))).empty());
  EXPECT_EQ(repeats.due(), canopen::kNever);
  EXPECT_TRUE(repeats.add("kind", ended(181, "d"))) << "after a minute without, at once";
}

TEST(JournalRepeats, KindsDoNotDisturbEachOther) {
  Repeats repeats;
  EXPECT_TRUE(repeats.add("one", ended(0, "a")));
  EXPECT_TRUE(repeats.add("other", ended(30, "b")));
  EXPECT_FALSE(repeats.add("one", ended(31, "c")));
  EXPECT_FALSE(repeats.add("other", ended(32, "d")));
  EXPECT_EQ(repeats.take_due(canopen::TimePoint(seconds(60))).size(), 1U);
  EXPECT_EQ(repeats.due(), canopen::TimePoint(seconds(90)));
}

TEST(JournalRepeats, AtAnEndNothingCountedIsLost) {
  Repeats repeats;
  EXPECT_TRUE(repeats.add("one", ended(0, "a")));
  EXPECT_TRUE(repeats.add("other", ended(0, "b")));
  EXPECT_FALSE(repeats.add("one", ended(1, "c")));
  EXPECT_EQ(repeats.take_all().size(), 1U);
  EXPECT_EQ(repeats.size(), 0U);
}

}  // namespace
}  // namespace journal
