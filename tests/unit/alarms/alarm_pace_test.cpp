#include "bridges/alarms/alarm_pace.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace alarms {
namespace {

using Milliseconds = std::chrono::milliseconds;
using canopen::TimePoint;

constexpr TimePoint kFirstChange{std::chrono::hours(1)};

struct Case {
  std::string name;
  std::vector<int> changes;  ///< Milliseconds.
  std::vector<int> told;
};

// A teller with a timer: it tells at once what is due, else when the pace says so.
std::vector<int> tellings(const std::vector<int>& changes) {
  AlarmPace pace;
  std::vector<int> told;
  std::size_t next_change = 0;
  TimePoint timer = canopen::kNever;
  for (int millisecond = 0; millisecond <= 5000; ++millisecond) {
    const TimePoint now = kFirstChange + Milliseconds(millisecond);
    for (; next_change < changes.size() && changes[next_change] == millisecond; ++next_change) {
      timer = pace.note(now);
      if (timer == now) {
        EXPECT_TRUE(pace.due(now));
        pace.told(now);
        told.push_back(millisecond);
        timer = canopen::kNever;
      }
    }
    if (timer <= now) {
      EXPECT_TRUE(pace.due(now));
      pace.told(now);
      told.push_back(millisecond);
      timer = canopen::kNever;
    }
    EXPECT_EQ(pace.next(), timer);
    EXPECT_FALSE(pace.due(now));
  }
  return told;
}

TEST(AlarmPaceTest, TheFirstAtOnceFurtherOnesPacedTheLastAlways) {
  std::vector<int> storm(1000);
  for (std::size_t i = 0; i < storm.size(); ++i) {
    storm[i] = static_cast<int>(i);
  }
  const std::vector<Case> cases{
      {"nothing", {}, {}},
      {"one", {3}, {3}},
      {"two in a row: the second is the last state", {0, 1}, {0, 500}},
      {"begin and end within one call", {7, 7}, {7, 507}},
      {"just before the pause is over", {0, 499}, {0, 500}},
      {"as it is over", {0, 500}, {0, 500}},
      {"after it", {0, 501}, {0, 501}},
      {"the pause begins with what was told, not with what changed", {0, 400, 600}, {0, 500, 1000}},
      {"twice a second, and after a rest at once again", {0, 250, 500, 750, 3000}, {0, 500, 1000, 3000}},
      {"a storm", storm, {0, 500, 1000}},
  };
  for (const Case& one : cases) {
    EXPECT_EQ(tellings(one.changes), one.told) << one.name;
  }
}

TEST(AlarmPaceTest, WhatCouldNotBeToldStaysDue) {
  AlarmPace pace;
  EXPECT_EQ(pace.note(kFirstChange), kFirstChange);
  EXPECT_TRUE(pace.due(kFirstChange));
  EXPECT_TRUE(pace.due(kFirstChange + Milliseconds(9000))) << "no connection until now";
  EXPECT_EQ(pace.note(kFirstChange + Milliseconds(9000)), kFirstChange + Milliseconds(9000));
  pace.told(kFirstChange + Milliseconds(9001));
  EXPECT_EQ(pace.next(), canopen::kNever);
  EXPECT_EQ(pace.note(kFirstChange + Milliseconds(9002)), kFirstChange + Milliseconds(9501));
}

}  // namespace
}  // namespace alarms
