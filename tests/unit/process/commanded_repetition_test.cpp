// What a supervised RPDO is repeated with, over several things that happen.

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "tests/unit/process/commanded_bench.h"

namespace process::commanded {
namespace {

class CommandedRepetitionTest : public CommandedTest {
 protected:
  [[nodiscard]] std::optional<Raw> repeated_word() const {
    const Frame frame = repeated();
    return frame ? std::optional(frame->front()) : std::nullopt;
  }
};

TEST_F(CommandedRepetitionTest, NothingIsRepeatedBeforeAllOfItHasLeftByRpdo) {
  by_sdo(control(kRun));
  by_sdo(frequency(3000));
  by_sdo(torque(7));
  EXPECT_EQ(repeated(), std::nullopt);
  confirm({frequency(4000)}, 1);
  EXPECT_EQ(repeated(), (std::vector<Raw>{kRun, 4000, 7}));
}

TEST_F(CommandedRepetitionTest, AFieldConfirmedBySdoReplacesItsValue) {
  by_rpdo(kRun);
  by_sdo(frequency(4000));
  EXPECT_EQ(repeated(), (std::vector<Raw>{kRun, 4000, 7}));
  by_sdo(control(kRamp));
  EXPECT_EQ(repeated(), (std::vector<Raw>{kRamp, 4000, 7}));
}

TEST_F(CommandedRepetitionTest, WhatAStandstillPutInItsPlaceGoesOnUntilAnotherControlCommandIsConfirmed) {
  by_rpdo(kRun);
  happens(Event::standstill);
  EXPECT_EQ(commanded_.held(control_), std::nullopt) << "nobody knows which of the two it holds";
  EXPECT_EQ(commanded_.repeated_control(), kCoast);
  by_sdo(frequency(4000));
  EXPECT_EQ(repeated(), (std::vector<Raw>{kCoast, 4000, 7}));
  happens(Event::standstill);
  EXPECT_EQ(repeated_word(), kCoast);
  by_rpdo(kRun);
  EXPECT_EQ(repeated_word(), kRun);
  EXPECT_EQ(commanded_.held(control_), kRun);
  EXPECT_TRUE(commanded_.counts(control_));
}

TEST_F(CommandedRepetitionTest, ASetPointThatCarriedARunWordOverAStandstillIsRepeatedWithTheStop) {
  by_rpdo(kRun);
  const Commanded::Epoch since = commanded_.epoch();
  happens(Event::standstill);
  confirm_since(since, {frequency(4000)}, 1);
  EXPECT_EQ(repeated(), (std::vector<Raw>{kCoast, 4000, 7}));
  EXPECT_TRUE(commanded_.counts(frequency_));
  EXPECT_FALSE(commanded_.counts(control_));
}

TEST_F(CommandedRepetitionTest, ASetPointThatCarriedARunWordOverAFaultIsNotRepeated) {
  for (const Event event : {Event::fault_begin, Event::fault_end}) {
    by_rpdo(kRun);
    const Commanded::Epoch since = commanded_.epoch();
    happens(event);
    confirm_since(since, {frequency(4000)}, 1);
    EXPECT_EQ(repeated(), std::nullopt) << to_string(event);
    EXPECT_TRUE(commanded_.counts(frequency_));
  }
}

TEST_F(CommandedRepetitionTest, ARunWordBySdoOverAStandstillDoesNotEnterTheRepetition) {
  by_rpdo(kRamp);
  const Commanded::Epoch since = commanded_.epoch();
  happens(Event::standstill);
  confirm_since(since, {control(kRun)}, 0);
  EXPECT_FALSE(commanded_.counts(control_));
  EXPECT_EQ(repeated_word(), kCoast);
}

TEST_F(CommandedRepetitionTest, AnEdgeResetGoesOnOverTheEndOfItsFaultAndEndsAtTheNextOne) {
  by_rpdo(kRun);
  happens(Event::fault_begin);
  ASSERT_EQ(repeated(), std::nullopt);
  by_rpdo(kEdgeReset);
  EXPECT_EQ(repeated(), (std::vector<Raw>{kEdgeReset, 3000, 7}));
  happens(Event::fault_end);
  happens(Event::fault_end);  // The emergency and the bit both tell it.
  EXPECT_EQ(repeated(), (std::vector<Raw>{kEdgeReset, 3000, 7}));
  EXPECT_EQ(completed({frequency(4000)}), std::nullopt);
  happens(Event::fault_begin);
  EXPECT_EQ(repeated(), std::nullopt);
  happens(Event::fault_end);
  EXPECT_EQ(repeated(), std::nullopt) << "nothing of before the fault";
}

TEST_F(CommandedRepetitionTest, AnEdgeResetIsRepeatedUntilAnotherFrameReplacesIt) {
  by_rpdo(kEdgeReset);
  by_rpdo(kRamp);
  EXPECT_EQ(repeated_word(), kRamp);
}

TEST_F(CommandedRepetitionTest, AMomentaryValueBySdoEndsTheRepetition) {
  for (const Raw word : {kReset, kEdgeReset}) {
    by_rpdo(kRamp);
    by_sdo(control(word));
    EXPECT_EQ(repeated(), std::nullopt);
    EXPECT_EQ(commanded_.held(control_), word);
  }
}

TEST_F(CommandedRepetitionTest, AStopCommandedDuringAFaultGoesOnAfterIt) {
  by_rpdo(kRun);
  happens(Event::fault_begin);
  happens(Event::stop_comes);
  EXPECT_EQ(repeated(), std::nullopt) << "not before it has left";
  by_rpdo(kRamp);
  happens(Event::fault_end);
  EXPECT_EQ(repeated_word(), kRamp);
}

TEST_F(CommandedRepetitionTest, ARunWordCommandedDuringAFaultDoesNotGoOnAfterIt) {
  happens(Event::fault_begin);
  by_rpdo(kRun);
  EXPECT_EQ(repeated_word(), kRun);
  happens(Event::fault_end);
  EXPECT_EQ(repeated(), std::nullopt);
}

TEST_F(CommandedRepetitionTest, AStopIsRepeatedFromItsArrivalAndNoOlderWordComesBack) {
  by_rpdo(kRun);
  const Commanded::Epoch since = commanded_.epoch();
  happens(Event::stop_comes);
  EXPECT_EQ(repeated_word(), kRamp);
  EXPECT_FALSE(commanded_.counts(control_));
  for (const Raw older : {kRun, kCoast, kEdgeReset}) {
    confirm_since(since, all(older), 1);
    EXPECT_EQ(repeated_word(), kRamp) << older;
  }
  by_rpdo(kRamp);
  EXPECT_EQ(repeated_word(), kRamp);
  EXPECT_TRUE(commanded_.counts(control_));
  EXPECT_EQ(commanded_.held(control_), kRamp);
}

TEST_F(CommandedRepetitionTest, AStopOnItsWayGoesOnOverAStandstillAndTheEndOfAFault) {
  by_rpdo(kRun);
  happens(Event::stop_comes);
  const Commanded::Epoch since = commanded_.epoch();
  happens(Event::standstill);
  EXPECT_EQ(repeated_word(), kRamp);
  happens(Event::fault_end);
  EXPECT_EQ(repeated_word(), kRamp);
  confirm_since(since, {control(kRamp)}, 1);
  EXPECT_EQ(repeated_word(), kRamp);
  EXPECT_FALSE(commanded_.counts(control_)) << "it came to a stop since it was handed over";
}

TEST_F(CommandedRepetitionTest, NothingIsRepeatedAfterASessionUntilAnRpdoHasLeft) {
  by_rpdo(kRun);
  happens(Event::standstill);
  happens(Event::session_end);
  EXPECT_EQ(repeated(), std::nullopt);
  by_sdo(control(kRamp));
  by_sdo(frequency(1));
  by_sdo(torque(1));
  EXPECT_EQ(repeated(), std::nullopt);
  by_rpdo(kRun);
  EXPECT_EQ(repeated_word(), kRun) << "what a standstill put in its place is gone, too";
}

TEST_F(CommandedRepetitionTest, AnRpdoWithoutAControlCommandCannotStartIt) {
  confirm({limit(50)}, 2);
  happens(Event::standstill);
  EXPECT_EQ(repeated(2), std::vector<Raw>{50});
  happens(Event::stop_comes);
  EXPECT_EQ(repeated(2), std::vector<Raw>{50});
  happens(Event::fault_begin);
  EXPECT_EQ(repeated(2), std::nullopt) << "nothing of before a fault";
  confirm({limit(60)}, 2);
  by_rpdo(kRun);
  happens(Event::fault_end);
  EXPECT_EQ(repeated(2), std::vector<Raw>{60}) << "commanded during it, and it starts nothing";
  EXPECT_EQ(repeated(1), std::nullopt);
  happens(Event::session_end);
  EXPECT_EQ(repeated(2), std::nullopt);
}

/// A profile that names no word that only stops.
class CommandedWithoutStopTest : public CommandedRepetitionTest {
 protected:
  CommandedWithoutStopTest() { model_.node.motor.stops.clear(); }
};

TEST_F(CommandedWithoutStopTest, RepetitionEndsAtAStandstill) {
  by_rpdo(kRun);
  const Commanded::Epoch since = commanded_.epoch();
  happens(Event::standstill);
  EXPECT_EQ(repeated(), std::nullopt);
  confirm_since(since, all(kRun), 1);
  EXPECT_EQ(repeated(), std::nullopt);
  EXPECT_FALSE(commanded_.counts(control_));
}

TEST_F(CommandedWithoutStopTest, AnEdgeResetGoesOnAllTheSame) {
  by_rpdo(kEdgeReset);
  happens(Event::standstill);
  EXPECT_EQ(repeated_word(), kEdgeReset);
}

/// Nothing is supervised, so nothing is put in the place of what the drive holds.
class CommandedUnsupervisedTest : public CommandedTest {
 protected:
  CommandedUnsupervisedTest() : CommandedTest(unsupervised()) {}

  static config::Drive unsupervised() {
    config::Drive drive = supervised_drive();
    for (canopen::PdoSettings& rpdo : drive.node.rpdos) {
      rpdo.event_timer.reset();
    }
    return drive;
  }
};

TEST_F(CommandedUnsupervisedTest, TheDriveHoldsWhatItWasToldLast) {
  for (const Event event : {Event::fault_begin, Event::fault_end, Event::standstill, Event::stop_comes}) {
    by_rpdo(kRun);
    happens(event);
    EXPECT_FALSE(commanded_.counts(control_)) << to_string(event);
    EXPECT_EQ(commanded_.held(control_), kRun) << to_string(event);
  }
  happens(Event::session_end);
  EXPECT_EQ(commanded_.held(control_), std::nullopt);
}

}  // namespace
}  // namespace process::commanded
