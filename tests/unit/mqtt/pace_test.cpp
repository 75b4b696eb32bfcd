#include "bridges/mqtt/pace.h"

#include <gtest/gtest.h>

#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using canopen::Raw;

constexpr canopen::TimePoint kNever = canopen::TimePoint::max();

class PaceTest : public testing::Test {
 protected:
  void SetUp() override { publish_all(); }

  // Everything is published as 0 and fresh, now.
  void publish_all() {
    for (std::size_t i = 0; i < drive_.signals.size(); ++i) {
      pace_.published_signal(static_cast<process::SignalId>(i), 0, true, now_);
    }
    pace_.published_state(now_);
  }

  canopen::TimePoint note(std::size_t signal, Raw raw, bool fresh = true) {
    return std::max(pace_.note(static_cast<process::SignalId>(signal), raw, fresh), now_);
  }
  [[nodiscard]] bool due(std::size_t signal) const {
    return pace_.signal_due(static_cast<process::SignalId>(signal), now_);
  }
  [[nodiscard]] bool state_due() const { return pace_.state_due(now_); }

  config::Drive drive_ = test::pump1();
  config::Mqtt settings_;
  Pace pace_{drive_, settings_};
  canopen::TimePoint now_{1h};
};

TEST_F(PaceTest, AtFirstEverythingReadableIsDue) {
  const Pace fresh(drive_, settings_);
  EXPECT_TRUE(fresh.signal_due(test::kFrequency, now_));
  EXPECT_TRUE(fresh.state_due(now_));
  EXPECT_FALSE(fresh.signal_due(test::kFrequencyCommand, now_)) << "only written";
}

TEST_F(PaceTest, WithoutAChangeNothingIsDue) {
  EXPECT_EQ(note(test::kFrequency, 0), kNever);
  now_ += 59s;
  EXPECT_FALSE(due(test::kFrequency));
  EXPECT_FALSE(state_due());
}

TEST_F(PaceTest, AChangeIsDueAfterTheShortestInterval) {
  now_ += 100ms;
  EXPECT_EQ(note(test::kFrequency, 1), canopen::TimePoint(1h) + 250ms);
  EXPECT_FALSE(due(test::kFrequency));
  EXPECT_FALSE(state_due());
  now_ = canopen::TimePoint(1h) + 250ms;
  EXPECT_TRUE(due(test::kFrequency));
  EXPECT_TRUE(state_due());
  EXPECT_FALSE(due(test::kStatusWord));
}

TEST_F(PaceTest, AfterAPauseAChangeIsDueAtOnce) {
  now_ += 1s;
  EXPECT_EQ(note(test::kFrequency, 1), now_);
  EXPECT_TRUE(due(test::kFrequency));
}

TEST_F(PaceTest, AChangeThatWentBackIsNone) {
  (void)note(test::kFrequency, 1);
  EXPECT_EQ(note(test::kFrequency, 0), kNever);
  now_ += 250ms;
  EXPECT_FALSE(due(test::kFrequency));
}

TEST_F(PaceTest, BooleansNamesAndFreshnessAreDueAtOnce) {
  EXPECT_EQ(note(test::kRunning, 1), now_);
  EXPECT_TRUE(due(test::kRunning));
  EXPECT_TRUE(state_due());
  publish_all();
  EXPECT_EQ(note(test::kState, 3), now_);
  EXPECT_TRUE(due(test::kState));
  publish_all();
  EXPECT_EQ(note(test::kFrequency, 0, false), now_);
  EXPECT_TRUE(due(test::kFrequency));
  EXPECT_TRUE(state_due());
}

TEST_F(PaceTest, FreshnessThatCameBackIsDueAtOnce) {
  pace_.published_signal(test::kFrequency, 7, false, now_);
  EXPECT_EQ(note(test::kFrequency, 9, false), kNever) << "emptied already";
  EXPECT_EQ(note(test::kFrequency, 7, true), now_);
}

TEST_F(PaceTest, EverythingFreshIsDueAgainAfterTheLongestInterval) {
  pace_.published_signal(test::kState, 0, false, now_);
  now_ += 60s;
  EXPECT_TRUE(due(test::kFrequency));
  EXPECT_TRUE(state_due());
  EXPECT_FALSE(due(test::kState)) << "an emptied topic stays empty";
  EXPECT_EQ(pace_.next(), now_);
}

TEST_F(PaceTest, AChangeWithinTheDeadbandIsNone) {
  drive_.signals[test::kFrequency].deadband = 0.1;
  now_ += 1s;
  EXPECT_EQ(note(test::kFrequency, 10), kNever) << "exactly the deadband";
  EXPECT_EQ(note(test::kFrequency, 11), now_);
  pace_.published_signal(test::kFrequency, 3000, true, now_);
  now_ += 1s;
  EXPECT_EQ(note(test::kFrequency, 3010), kNever);
  EXPECT_EQ(note(test::kFrequency, 2989), now_);
}

TEST_F(PaceTest, ABitOutsideOfThePublishMaskIsNoChange) {
  now_ += 1s;
  EXPECT_EQ(note(test::kStatusWord, 0x8000), kNever);
  EXPECT_EQ(note(test::kStatusWord, 0x8001), now_);
}

TEST_F(PaceTest, WithoutAShortestIntervalEveryChangeIsDue) {
  settings_.min_interval = {};
  EXPECT_EQ(note(test::kFrequency, 1), now_);
  pace_.published_signal(test::kFrequency, 1, true, now_);
  EXPECT_EQ(note(test::kFrequency, 2), now_);
  EXPECT_TRUE(due(test::kFrequency));
}

TEST_F(PaceTest, WhatIsSwitchedOffIsNeverDue) {
  settings_.signals = false;
  now_ += 61s;
  EXPECT_FALSE(due(test::kFrequency));
  EXPECT_TRUE(state_due());
  settings_.signals = true;
  settings_.state = false;
  EXPECT_FALSE(state_due());
  EXPECT_TRUE(due(test::kFrequency));
}

TEST_F(PaceTest, ANewConnectionNeedsEverything) {
  pace_.forget();
  EXPECT_TRUE(due(test::kFrequency));
  EXPECT_TRUE(state_due());
}

TEST_F(PaceTest, ANewNmtStateIsDueAtOnce) {
  pace_.note_state();
  EXPECT_TRUE(state_due());
  EXPECT_FALSE(due(test::kFrequency));
}

}  // namespace
}  // namespace mqtt
