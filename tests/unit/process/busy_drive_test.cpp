// Stops to a drive that is slow and commanded all the time.

#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tests/unit/process/stop_first_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

/// One signal set 15 times a second by a client, and a stop each second by another, for a minute.
class BusyDriveTest : public StopFirstTest {
 protected:
  struct Stop {
    Sent sent;
    canopen::TimePoint at;
    std::optional<canopen::TimePoint> on_wire{};
    std::optional<canopen::TimePoint> answered{};
  };

  void begin_what_is_due(int ms) {
    if (ms % 66 == 0) {
      asked_ = 1000 + canopen::Raw(ms / 66);
      set_points_.push_back(write_by(origin(), {field("frequency_command", asked_)}));
    }
    if (ms % 1000 == 500) {
      slave_.forget_heard();
      stops_.push_back({stop_by(Writer::Way::mqtt), canopen::Clock::now()});
    }
  }
  void look() {
    if (stops_.empty()) {
      return;
    }
    Stop& newest = stops_.back();
    if (!newest.on_wire && control_on_wire()) {
      newest.on_wire = canopen::Clock::now();
    }
    if (!newest.answered && newest.sent.done()) {
      newest.answered = canopen::Clock::now();
    }
  }

  std::vector<Sent> set_points_;
  std::vector<Stop> stops_;
  canopen::Raw asked_ = 0;
};

TEST_F(BusyDriveTest, EachStopIsOnTheWireAndConfirmedInTimeAndNoSetPointIsUnknown) {
  bring_online();
  slave_.delay_answers(100ms);
  for (int ms = 0; ms < 60'000; ++ms) {
    begin_what_is_due(ms);
    run(1ms);
    look();
  }
  run(1s);
  look();
  ASSERT_EQ(stops_.size(), 60U);
  for (const Stop& stop : stops_) {
    ASSERT_TRUE(stop.on_wire && stop.answered);
    EXPECT_LE(*stop.on_wire - stop.at, 150ms);
    EXPECT_LE(*stop.answered - stop.at, 300ms);
    EXPECT_TRUE(stop.sent.get().has_value());
  }
  std::map<std::string, int> outcomes;
  for (const Sent& sent : set_points_) {
    ASSERT_TRUE(sent.done());
    const Outcome outcome = sent.get();
    ++outcomes[outcome.has_value() ? "ok" : std::string(name_of(outcome.error().kind))];
  }
  EXPECT_GE(outcomes["ok"], 300);
  EXPECT_EQ(outcomes["ok"] + outcomes["superseded"], static_cast<int>(set_points_.size()))
      << testing::PrintToString(outcomes);
  EXPECT_EQ(slave_.value(test::kFrequency), asked_);
}

}  // namespace
}  // namespace process
