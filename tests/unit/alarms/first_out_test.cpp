#include "bridges/alarms/first_out.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <utility>

namespace alarms {
namespace {

using namespace std::chrono_literals;
using canopen::TimePoint;

constexpr TimePoint kFirstTime{1h};
constexpr FaultSource kBus{.bus = true};

constexpr FaultSource drive(std::size_t index, AlarmKind kind = AlarmKind::emcy) {
  return {.index = index, .kind = kind};
}

class FirstOutTest : public testing::Test {
 protected:
  /// An alarm becomes active.
  void begin(const FaultSource& source, canopen::Duration at) {
    shown_[source] = false;
    first_out_.on_fault(source, kFirstTime + at, false);
  }
  /// One more error in an alarm that is active.
  void more(const FaultSource& source, canopen::Duration at) {
    first_out_.on_fault(source, kFirstTime + at, shown_[source]);
  }
  [[nodiscard]] bool first(const FaultSource& source) const { return shown_.at(source); }
  [[nodiscard]] std::optional<FaultSource> newest() const { return first_out_.newest_group(); }

  std::map<FaultSource, bool> shown_;
  int told_ = 0;
  FirstOut first_out_{[this](const FaultSource& source, bool first) {
    EXPECT_NE(shown_.at(source), first) << "only what changes is told";
    shown_[source] = first;
    ++told_;
  }};
};

TEST_F(FirstOutTest, NoFaultNoFirst) {
  EXPECT_EQ(newest(), std::nullopt);
}

TEST_F(FirstOutTest, TheFirstOfSomeIsFirst) {
  begin(drive(2), 0ms);
  begin(drive(0), 1ms);
  begin(kBus, 2ms);
  EXPECT_TRUE(first(drive(2)));
  EXPECT_FALSE(first(drive(0)));
  EXPECT_FALSE(first(kBus));
  EXPECT_EQ(newest(), drive(2));
  EXPECT_EQ(told_, 1);
}

TEST_F(FirstOutTest, AGroupGoesOnAsLongAsNoTwoSecondsPass) {
  begin(drive(0), 0ms);
  begin(drive(1), 2s);
  begin(drive(2), 4s);
  EXPECT_FALSE(first(drive(1))) << "two seconds before is within them";
  EXPECT_FALSE(first(drive(2)));
  begin(drive(3), 6s + 1ns);
  EXPECT_TRUE(first(drive(3)));
  EXPECT_TRUE(first(drive(0))) << "of its own group it stays";
  EXPECT_EQ(newest(), drive(3));
}

TEST_F(FirstOutTest, TheFirstThatTripsAgainStaysFirst) {
  begin(drive(0), 0ms);
  begin(drive(1), 500ms);
  begin(drive(0), 1s);
  EXPECT_TRUE(first(drive(0))) << "as the newest group says";
  EXPECT_EQ(newest(), drive(0));
  begin(drive(1), 2s);
  EXPECT_FALSE(first(drive(1)));
}

TEST_F(FirstOutTest, TheFirstThatTrippedAgainLosesTheFlagToAnEarlierOne) {
  begin(drive(0), 1s);
  begin(drive(0), 2s);
  begin(drive(1), 500ms);
  EXPECT_FALSE(first(drive(0)));
  EXPECT_TRUE(first(drive(1)));
  EXPECT_EQ(newest(), drive(1));
}

TEST_F(FirstOutTest, TheFirstOfTwoGroupsThatBecomeOneStaysFirst) {
  begin(drive(0), 0ms);
  begin(drive(0), 3s);
  begin(drive(1), 1500ms);
  EXPECT_TRUE(first(drive(0)));
  EXPECT_FALSE(first(drive(1)));
  EXPECT_EQ(newest(), drive(0));
}

TEST_F(FirstOutTest, AnotherKindOfTheSameDriveIsAnotherFault) {
  begin(drive(0, AlarmKind::heartbeat), 0ms);
  begin(drive(0), 1ms);
  EXPECT_TRUE(first(drive(0, AlarmKind::heartbeat)));
  EXPECT_FALSE(first(drive(0)));
}

TEST_F(FirstOutTest, AnAlarmThatStandsForDaysChangesNothing) {
  begin(drive(7), 0ms);
  begin(drive(1), 100h);
  begin(drive(2), 100h + 5ms);
  EXPECT_TRUE(first(drive(7)));
  EXPECT_TRUE(first(drive(1)));
  EXPECT_FALSE(first(drive(2)));
}

TEST_F(FirstOutTest, AnEarlierFaultThatIsToldLaterTakesTheFlag) {
  begin(drive(0), 5ms);
  EXPECT_TRUE(first(drive(0)));
  begin(drive(4), 3ms);
  EXPECT_FALSE(first(drive(0)));
  EXPECT_TRUE(first(drive(4)));
  EXPECT_EQ(newest(), drive(4));
  begin(kBus, 4ms);
  EXPECT_FALSE(first(kBus));
  begin(kBus, 1ms);
  EXPECT_TRUE(first(kBus));
  EXPECT_FALSE(first(drive(4)));
  EXPECT_EQ(newest(), kBus);
}

TEST_F(FirstOutTest, OfEqualTimesTheOneToldFirst) {
  begin(drive(3), 5ms);
  begin(drive(1), 5ms);
  EXPECT_TRUE(first(drive(3)));
  EXPECT_FALSE(first(drive(1)));
}

TEST_F(FirstOutTest, AFaultBetweenTwoGroupsMakesThemOne) {
  begin(drive(0), 0ms);
  begin(drive(1), 3s);
  ASSERT_TRUE(first(drive(1)));
  begin(drive(2), 1500ms);
  EXPECT_TRUE(first(drive(0)));
  EXPECT_FALSE(first(drive(1)));
  EXPECT_FALSE(first(drive(2)));
  EXPECT_EQ(newest(), drive(0));
  begin(drive(3), 5s);
  EXPECT_FALSE(first(drive(3))) << "the end of the later group counts";
}

TEST_F(FirstOutTest, AFaultBeforeAGroupAndTooLateForTheOneBeforeIsFirst) {
  begin(drive(0), 0ms);
  begin(drive(1), 4s);
  begin(drive(2), 3s);
  EXPECT_TRUE(first(drive(0)));
  EXPECT_TRUE(first(drive(2)));
  EXPECT_FALSE(first(drive(1)));
  EXPECT_EQ(newest(), drive(2));
}

TEST_F(FirstOutTest, AnOlderGroupThatIsToldLaterIsNotTheNewest) {
  begin(drive(0), 10s);
  begin(drive(1), 1s);
  EXPECT_TRUE(first(drive(0)));
  EXPECT_TRUE(first(drive(1)));
  EXPECT_EQ(newest(), drive(0));
}

TEST_F(FirstOutTest, OneMoreErrorInAnActiveAlarm) {
  begin(drive(0), 0ms);
  begin(drive(1), 1ms);
  more(drive(1), 10s);
  EXPECT_TRUE(first(drive(1))) << "it is first of its own group";
  EXPECT_EQ(newest(), drive(1));
  begin(drive(2), 20s);
  more(drive(0), 20s + 1ms);
  EXPECT_TRUE(first(drive(0))) << "it stays as it was";
  more(drive(2), 19s);
  EXPECT_TRUE(first(drive(2))) << "it took it from itself";
  EXPECT_EQ(told_, 3);
}

TEST_F(FirstOutTest, WhatAnAlarmLosesIsWhatThatGroupGaveIt) {
  begin(drive(0), 0ms);
  more(drive(0), 10s);
  begin(drive(1), 10s - 1ms);
  EXPECT_TRUE(first(drive(1)));
  EXPECT_TRUE(first(drive(0))) << "still first of the group of the beginning";
}

TEST_F(FirstOutTest, ANewActivationHasNothingOfTheOldOne) {
  begin(drive(0), 0ms);
  begin(drive(0), 1s);
  EXPECT_TRUE(first(drive(0))) << "of the group, with a flag of its own";
  EXPECT_EQ(newest(), drive(0));
  begin(drive(1), -1ms);
  EXPECT_TRUE(first(drive(1)));
  EXPECT_FALSE(first(drive(0)));
  begin(drive(0), 10s);
  EXPECT_TRUE(first(drive(0)));
}

TEST_F(FirstOutTest, AfterARestartTheNewestGroupHoldsUntilOneBegins) {
  first_out_.restore(drive(5));
  shown_[drive(5)] = true;
  shown_[drive(6)] = false;
  EXPECT_EQ(newest(), drive(5));
  more(drive(6), 0ms);
  EXPECT_EQ(newest(), drive(6));
  EXPECT_TRUE(first(drive(6)));
  more(drive(5), 1ms);
  EXPECT_TRUE(first(drive(5))) << "from before";
  more(drive(5), 10s);
  begin(drive(0), 10s - 1ms);
  EXPECT_TRUE(first(drive(0)));
  EXPECT_TRUE(first(drive(5))) << "it loses what it got since, not what it had";
}

TEST_F(FirstOutTest, OlderThanAllThatIsRememberedNobodyCanTell) {
  for (std::size_t i = 0; i < 3 * FirstOut::kMaxGroups; ++i) {
    begin(drive(i % 5), 3s * i);
  }
  begin(drive(9), 0s);
  EXPECT_FALSE(first(drive(9)));
  EXPECT_EQ(newest(), drive((3 * FirstOut::kMaxGroups - 1) % 5));
}

/// The rule itself, over a list of all faults.
std::set<std::size_t> firsts_of(const std::vector<std::pair<canopen::Duration, std::size_t>>& faults) {
  // Equal times stay in the order in which they were told.
  const std::multimap<canopen::Duration, std::size_t> in_order(faults.begin(), faults.end());
  std::set<std::size_t> firsts;
  std::optional<canopen::Duration> before;
  for (const auto& [at, source] : in_order) {
    if (!before || at - *before > 2s) {
      firsts.insert(source);
    }
    before = at;
  }
  return firsts;
}

TEST_F(FirstOutTest, WhateverTheOrderTheRuleHolds) {
  std::mt19937 random(7);  // NOLINT(cert-msc32-c,cert-msc51-cpp,bugprone-random-generator-seed): the same every time.
  for (int round = 0; round < 200; ++round) {
    std::vector<std::pair<canopen::Duration, std::size_t>> faults;
    const canopen::Duration base = 1h * round;
    for (std::size_t i = 0; i < 8; ++i) {
      faults.emplace_back(base + 500ms * std::uniform_int_distribution<int>(0, 30)(random), i);
    }
    for (const auto& [at, index] : faults) {
      begin(drive(index), at);
    }
    const std::set<std::size_t> expected = firsts_of(faults);
    std::set<std::size_t> firsts;
    for (std::size_t i = 0; i < 8; ++i) {
      if (first(drive(i))) {
        firsts.insert(i);
      }
    }
    EXPECT_EQ(firsts, expected) << "round " << round;
  }
}

}  // namespace
}  // namespace alarms
