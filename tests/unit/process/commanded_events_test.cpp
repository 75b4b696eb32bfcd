// What still counts after something made it void, and what a supervised RPDO goes on with.

#include <gtest/gtest.h>

#include <optional>
#include <ostream>
#include <vector>

#include "tests/unit/process/commanded_bench.h"

namespace process::commanded {
namespace {

constexpr std::optional<Raw> kSilent = std::nullopt;

/// RPDO1 with `word` has left, or is on its way; then something happens.
struct Case {
  Raw word;
  Event event;
  bool counts;                  ///< `word`, afterwards.
  std::optional<Raw> repeated;  ///< The control command in what is repeated; nothing: silence.
};

std::ostream& operator<<(std::ostream& out, const Case& what) {
  return out << "word " << what.word << ", " << to_string(what.event);
}

class CommandedEventTest : public CommandedTest, public testing::WithParamInterface<Case> {
 protected:
  void expect_as_told() const {
    const Case& expected = GetParam();
    const bool ended = expected.event == Event::session_end;
    EXPECT_EQ(commanded_.counts(control_), expected.counts);
    EXPECT_EQ(commanded_.known(control_), expected.counts ? std::optional(expected.word) : std::nullopt);
    EXPECT_EQ(commanded_.confirmed_at(control_), expected.counts ? std::optional(now_) : std::nullopt);
    EXPECT_EQ(commanded_.shown(control_), expected.word) << "it was confirmed once";
    EXPECT_EQ(commanded_.known(frequency_), ended ? std::nullopt : std::optional(Raw{3000}))
        << "set-points stay known until the session ends";
    EXPECT_EQ(completed({frequency(4000)}).has_value(), expected.counts)
        << "a set-point carries no run command that nobody gave since";
    EXPECT_EQ(completed({control(kRun)}).has_value(), !ended);
    const Frame frame = expected.repeated ? Frame({*expected.repeated, 3000, 7}) : std::nullopt;
    EXPECT_EQ(repeated(), frame);
  }
};

class CommandedBeforeTest : public CommandedEventTest {};

TEST_P(CommandedBeforeTest, WhatWasConfirmedBefore) {
  by_rpdo(GetParam().word);
  happens(GetParam().event);
  expect_as_told();
}

INSTANTIATE_TEST_SUITE_P(Each, CommandedBeforeTest,
                         testing::ValuesIn(std::vector<Case>{
                             {kRun, Event::none, true, kRun},
                             {kRun, Event::fault_begin, false, kSilent},
                             {kRun, Event::fault_end, false, kSilent},
                             {kRun, Event::standstill, false, kCoast},
                             {kRun, Event::stop_comes, false, kRamp},
                             {kRun, Event::session_end, false, kSilent},
                             {kCoast, Event::none, true, kCoast},
                             {kCoast, Event::fault_begin, false, kSilent},
                             {kCoast, Event::fault_end, false, kCoast},
                             {kCoast, Event::standstill, false, kCoast},
                             {kCoast, Event::stop_comes, false, kRamp},
                             {kCoast, Event::session_end, false, kSilent},
                             {kRamp, Event::standstill, false, kRamp},
                             {kEdgeReset, Event::none, false, kEdgeReset},
                             {kEdgeReset, Event::fault_begin, false, kSilent},
                             {kEdgeReset, Event::fault_end, false, kEdgeReset},
                             {kEdgeReset, Event::standstill, false, kEdgeReset},
                             {kEdgeReset, Event::stop_comes, false, kRamp},
                             {kEdgeReset, Event::session_end, false, kSilent},
                             {kReset, Event::none, false, kSilent},
                             {kReset, Event::fault_begin, false, kSilent},
                             {kReset, Event::fault_end, false, kSilent},
                             {kReset, Event::standstill, false, kSilent},
                             {kReset, Event::stop_comes, false, kSilent},
                             {kReset, Event::session_end, false, kSilent},
                         }));

class CommandedMeanwhileTest : public CommandedEventTest {};

TEST_P(CommandedMeanwhileTest, WhatIsConfirmedAfterItAndWasHandedOverBefore) {
  by_rpdo(kRun);
  const Commanded::Epoch since = commanded_.epoch();
  happens(GetParam().event);
  confirm_since(since, all(GetParam().word), 1);
  expect_as_told();
}

INSTANTIATE_TEST_SUITE_P(Each, CommandedMeanwhileTest,
                         testing::ValuesIn(std::vector<Case>{
                             {kRun, Event::none, true, kRun},
                             {kRun, Event::fault_begin, false, kSilent},
                             {kRun, Event::fault_end, false, kSilent},
                             {kRun, Event::standstill, false, kCoast},
                             {kRun, Event::stop_comes, false, kRamp},
                             {kRun, Event::session_end, false, kSilent},
                             {kCoast, Event::none, true, kCoast},
                             {kCoast, Event::fault_begin, false, kSilent},
                             {kCoast, Event::fault_end, false, kCoast},
                             {kCoast, Event::standstill, false, kCoast},
                             {kCoast, Event::stop_comes, false, kRamp},
                             {kCoast, Event::session_end, false, kSilent},
                             {kRamp, Event::standstill, false, kRamp},
                             {kEdgeReset, Event::fault_begin, false, kSilent},
                             {kEdgeReset, Event::fault_end, false, kEdgeReset},
                             {kEdgeReset, Event::standstill, false, kEdgeReset},
                             {kEdgeReset, Event::stop_comes, false, kRamp},
                             {kEdgeReset, Event::session_end, false, kSilent},
                             {kReset, Event::fault_begin, false, kSilent},
                             {kReset, Event::fault_end, false, kSilent},
                             {kReset, Event::standstill, false, kSilent},
                             {kReset, Event::stop_comes, false, kSilent},
                             {kReset, Event::session_end, false, kSilent},
                         }));

}  // namespace
}  // namespace process::commanded
