#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "bridges/alarms/first_out.h"

namespace alarms {
namespace {

using namespace std::chrono_literals;
using canopen::TimePoint;

constexpr TimePoint kMoveTime{1h};

constexpr FaultSource moved_drive(std::size_t index) {
  return {.index = index, .kind = AlarmKind::emcy};
}

class FirstOutMoveTest : public testing::Test {
 protected:
  void begin(std::size_t index, canopen::Duration at) {
    first_out_.on_fault(moved_drive(index), kMoveTime + at, false);
  }
  /// Of each old position the new one; nothing: gone.
  void move(std::vector<std::optional<std::size_t>> now) {
    first_out_.move([&now](const FaultSource& source) -> std::optional<FaultSource> {
      return now[source.index] ? std::optional(moved_drive(*now[source.index])) : std::nullopt;
    });
  }

  std::vector<std::pair<FaultSource, bool>> told_;
  FirstOut first_out_{[this](const FaultSource& source, bool first) { told_.emplace_back(source, first); }};
};

TEST_F(FirstOutMoveTest, TheFirstIsWhereItsDriveIsNow) {
  begin(0, 0s);
  begin(1, 1s);
  move({2, 0, 1});
  EXPECT_EQ(first_out_.newest_group(), moved_drive(2));
  EXPECT_EQ(told_.size(), 1U) << "a move alone changes no flag";
  // An earlier fault that is told late takes the flag from where it is now.
  begin(0, -1s);
  EXPECT_EQ(first_out_.newest_group(), moved_drive(0));
  ASSERT_EQ(told_.size(), 3U);
  EXPECT_EQ(told_[1], std::pair(moved_drive(2), false));
  EXPECT_EQ(told_[2], std::pair(moved_drive(0), true));
}

TEST_F(FirstOutMoveTest, WhatIsGoneWasNoFirst) {
  begin(0, 0s);
  begin(1, 10s);
  move({0, std::nullopt});
  EXPECT_EQ(first_out_.newest_group(), moved_drive(0));
  // A new one in that place does not have its past.
  begin(1, 11s);
  EXPECT_EQ(first_out_.newest_group(), moved_drive(1));
  EXPECT_EQ(told_.back(), std::pair(moved_drive(1), true));
}

TEST_F(FirstOutMoveTest, WhatWasRestoredMovesToo) {
  first_out_.restore(moved_drive(1));
  move({std::nullopt, 0});
  EXPECT_EQ(first_out_.newest_group(), moved_drive(0));
  move({std::nullopt});
  EXPECT_EQ(first_out_.newest_group(), std::nullopt);
}

}  // namespace
}  // namespace alarms
