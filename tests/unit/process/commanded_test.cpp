// What is known of what was commanded, and what completes an RPDO.

#include "bridges/process/commanded.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "tests/unit/process/commanded_bench.h"

namespace process::commanded {
namespace {

TEST_F(CommandedTest, NothingIsKnownAtTheStart) {
  EXPECT_EQ(commanded_.shown(control_), 0U);
  EXPECT_FALSE(commanded_.counts(control_));
  EXPECT_EQ(commanded_.known(control_), std::nullopt);
  EXPECT_EQ(commanded_.held(control_), std::nullopt);
  EXPECT_EQ(commanded_.confirmed_at(control_), std::nullopt);
  EXPECT_EQ(commanded_.doubtful_at(control_), std::nullopt);
  EXPECT_EQ(commanded_.repeated_control(), std::nullopt);
  EXPECT_EQ(repeated(), std::nullopt);
  EXPECT_TRUE(commanded_.control_void_since(0).empty());
  EXPECT_TRUE(commanded_.all_void_since(0).empty());
}

TEST_F(CommandedTest, AConfirmedValueIsKnownFromThenOn) {
  by_sdo(frequency(3000));
  EXPECT_EQ(commanded_.shown(frequency_), 3000U);
  EXPECT_TRUE(commanded_.counts(frequency_));
  EXPECT_EQ(commanded_.known(frequency_), 3000U);
  EXPECT_EQ(commanded_.held(frequency_), 3000U);
  EXPECT_EQ(commanded_.confirmed_at(frequency_), now_);
  EXPECT_FALSE(commanded_.counts(torque_));
}

TEST_F(CommandedTest, AnRpdoIsIncompleteUntilEveryFieldIsGivenOrCounts) {
  EXPECT_EQ(completed({}), std::nullopt);
  EXPECT_EQ(completed({frequency(3000)}), std::nullopt);
  EXPECT_EQ(commanded_.missing(1, {}), (std::vector<SignalId>{control_, frequency_, torque_}));
  by_sdo(frequency(3000));
  by_sdo(torque(7));
  EXPECT_EQ(completed({}), std::nullopt);
  EXPECT_EQ(commanded_.missing(1, {}), std::vector<SignalId>{control_});
  EXPECT_EQ(completed({control(kRun)}), (std::vector<Raw>{kRun, 3000, 7}));
  EXPECT_EQ(commanded_.missing(1, std::vector{control(kRun)}), std::vector<SignalId>{});
}

TEST_F(CommandedTest, FieldsTogetherCompleteItWithTheObjectsAndTypesOfItsMapping) {
  const auto values = commanded_.values(1, std::vector{torque(static_cast<Raw>(-1)), frequency(5000), control(kRun)});
  EXPECT_EQ(values, (std::vector<ObjectValue>{{test::kControl, canopen::DataType::u16, kRun},
                                              {test::kFrequency, canopen::DataType::u16, 5000},
                                              {test::kTorque, canopen::DataType::i16, static_cast<Raw>(-1)}}));
}

TEST_F(CommandedTest, AskingCommandsNothing) {
  ASSERT_TRUE(completed(all(kRun)));
  EXPECT_EQ(completed({}), std::nullopt);
  EXPECT_EQ(repeated(), std::nullopt);
}

TEST_F(CommandedTest, AGivenFieldGoesOverOneThatCounts) {
  by_rpdo(kRun);
  EXPECT_EQ(completed({frequency(4000)}), (std::vector<Raw>{kRun, 4000, 7}));
  EXPECT_EQ(repeated(), (std::vector<Raw>{kRun, 3000, 7})) << "until it has left";
}

TEST_F(CommandedTest, AFieldOfAnotherRpdoOrOfNoneIsNeverDroppedSilently) {
  by_rpdo(kRun);
  EXPECT_EQ(completed({frequency(4000), limit(1)}), std::nullopt);
  EXPECT_EQ(completed({limit(1)}), std::nullopt);
  EXPECT_EQ(completed({limit(1)}, 2), std::vector<Raw>{1});
  EXPECT_EQ(completed({frequency(4000)}, 3), std::nullopt);
  EXPECT_EQ(commanded_.missing(3, {}), std::nullopt);
}

TEST_F(CommandedTest, EachSignalHasItsRpdo) {
  EXPECT_EQ(commanded_.rpdo_of(torque_), 1U);
  EXPECT_EQ(commanded_.rpdo_of(limit_), 2U);
  EXPECT_EQ(commanded_.rpdo_of(test::id(model_, "status_word")), 0U);
  EXPECT_TRUE(commanded_.is_supervised(torque_));
  EXPECT_FALSE(commanded_.is_supervised(test::id(model_, "status_word")));
}

TEST_F(CommandedTest, OnlyWhatStopsAndIsNotMomentaryIsAStop) {
  model_.node.motor.stops.push_back({.equals = kReset});
  EXPECT_TRUE(commanded_.is_stop(kCoast));
  EXPECT_TRUE(commanded_.is_stop(kRamp));
  EXPECT_FALSE(commanded_.is_stop(kRun));
  EXPECT_FALSE(commanded_.is_stop(kReset)) << "a reset is no stop, whatever the list says";
}

TEST_F(CommandedTest, AMomentaryValueIsShownAndHeldAndDoesNotCount) {
  for (const Raw word : {kReset, kEdgeReset}) {
    by_rpdo(word);
    EXPECT_EQ(commanded_.shown(control_), word);
    EXPECT_EQ(commanded_.held(control_), word);
    EXPECT_FALSE(commanded_.counts(control_));
    EXPECT_EQ(commanded_.confirmed_at(control_), std::nullopt);
    EXPECT_EQ(completed({frequency(4000)}), std::nullopt);
    EXPECT_EQ(completed({control(kRun)}), (std::vector<Raw>{kRun, 3000, 7}));
  }
}

TEST_F(CommandedTest, WhereNobodyCanTellWhetherTheMotorTurnsAControlCommandDoesNotCount) {
  commanded_.confirm(all(kRun), 1, commanded_.epoch(), false, now_);
  EXPECT_FALSE(commanded_.counts(control_));
  EXPECT_TRUE(commanded_.counts(frequency_));
  EXPECT_EQ(commanded_.shown(control_), kRun);
  EXPECT_EQ(commanded_.held(control_), kRun);
  EXPECT_EQ(completed({frequency(4000)}), std::nullopt);
  EXPECT_EQ(repeated(), (std::vector<Raw>{kRun, 3000, 7})) << "it was commanded just so";
}

TEST_F(CommandedTest, AnUnknownOutcomeUnknowsItsFieldsOnly) {
  by_rpdo(kRun);
  commanded_.doubt(std::vector{control(kCoast)}, commanded_.epoch(), now_ + kTick);
  EXPECT_EQ(commanded_.shown(control_), kRun);
  EXPECT_FALSE(commanded_.counts(control_));
  EXPECT_EQ(commanded_.held(control_), std::nullopt);
  EXPECT_EQ(commanded_.doubtful_at(control_), now_ + kTick);
  EXPECT_TRUE(commanded_.counts(frequency_));
  EXPECT_EQ(commanded_.doubtful_at(frequency_), std::nullopt);
  EXPECT_EQ(completed({frequency(4000)}), std::nullopt);
  EXPECT_EQ(completed({control(kCoast)}), (std::vector<Raw>{kCoast, 3000, 7}));
  EXPECT_EQ(repeated(), std::nullopt) << "it may have stopped: the frame before would start it again";
  by_sdo(control(kCoast));
  EXPECT_TRUE(commanded_.counts(control_));
  EXPECT_EQ(repeated(), std::nullopt) << "none has left by RPDO since";
  by_rpdo(kCoast);
  EXPECT_EQ(repeated(), (std::vector<Raw>{kCoast, 3000, 7}));
}

TEST_F(CommandedTest, AnUnknownOutcomeOfAnotherRpdoEndsNoRepetition) {
  by_rpdo(kRun);
  confirm({limit(50)}, 2);
  commanded_.doubt(std::vector{limit(60)}, commanded_.epoch(), now_);
  EXPECT_EQ(repeated(2), std::nullopt);
  EXPECT_EQ(repeated(1), (std::vector<Raw>{kRun, 3000, 7}));
}

TEST_F(CommandedTest, EpochsTellWhatBecameVoidSinceAndWhy) {
  const Commanded::Epoch before = commanded_.epoch();
  happens(Event::fault_begin);
  EXPECT_EQ(commanded_.control_void_since(before), "a fault began");
  EXPECT_TRUE(commanded_.all_void_since(before).empty());
  const Commanded::Epoch between = commanded_.epoch();
  EXPECT_TRUE(commanded_.control_void_since(between).empty());
  happens(Event::session_end);
  EXPECT_EQ(commanded_.control_void_since(between), "it rebooted");
  EXPECT_EQ(commanded_.all_void_since(between), "it rebooted");
  EXPECT_EQ(commanded_.all_void_since(before), "it rebooted");
  EXPECT_TRUE(commanded_.all_void_since(commanded_.epoch()).empty());
}

TEST_F(CommandedTest, ASetPointThatWasOnItsWayAtASessionsEndIsShownOnly) {
  const Commanded::Epoch since = commanded_.epoch();
  happens(Event::session_end);
  confirm_since(since, all(kRun), 1);
  for (const SignalId signal : {control_, frequency_, torque_}) {
    EXPECT_NE(commanded_.shown(signal), 0U);
    EXPECT_FALSE(commanded_.counts(signal));
    EXPECT_EQ(commanded_.held(signal), std::nullopt);
  }
  EXPECT_EQ(repeated(), std::nullopt);
}

/// The same drive with another RPDO1.
class CommandedMappingTest : public CommandedTest {
 protected:
  CommandedMappingTest() : CommandedTest(test::drive()) {}

  /// A fresh one, for the model as it is now.
  [[nodiscard]] Commanded fresh() const { return Commanded(model_); }
  [[nodiscard]] std::vector<canopen::MappedObject>& mapping() { return model_.node.rpdos[0].mapping; }
};

TEST_F(CommandedMappingTest, UnusedFieldsAndGapsAreNotCommanded) {
  mapping()[2].use = canopen::FieldUse::unused;
  mapping().push_back({{0x0006, 0}});
  const Commanded commanded = fresh();
  EXPECT_EQ(commanded.rpdo_of(torque_), 0U);
  EXPECT_EQ(raw_of(commanded.values(1, std::vector{control(kRun), frequency(5000)})), (std::vector<Raw>{kRun, 5000}));
  EXPECT_EQ(commanded.values(1, all(kRun)), std::nullopt) << "no value is dropped silently";
}

TEST_F(CommandedMappingTest, AnUnnamedFieldMakesItNeverComplete) {
  mapping()[2].use = canopen::FieldUse::unnamed;
  const Commanded commanded = fresh();
  EXPECT_EQ(commanded.values(1, std::vector{control(kRun), frequency(5000)}), std::nullopt);
  EXPECT_EQ(commanded.values(1, all(kRun)), std::nullopt);
  EXPECT_EQ(commanded.missing(1, all(kRun)), std::nullopt);
}

TEST_F(CommandedMappingTest, AFieldThatNoWritableSignalNamesMakesItNeverComplete) {
  mapping()[2].object = test::kStatusWord;  // Only read.
  const Commanded commanded = fresh();
  EXPECT_EQ(commanded.values(1, std::vector{control(kRun), frequency(5000)}), std::nullopt);
  EXPECT_EQ(commanded.missing(1, {}), std::nullopt);
}

TEST_F(CommandedMappingTest, AnEmptyMappingIsNeverComplete) {
  mapping().clear();
  EXPECT_EQ(fresh().values(1, {}), std::nullopt);
  EXPECT_EQ(fresh().missing(1, {}), std::nullopt);
}

TEST_F(CommandedMappingTest, AnUnsupervisedRpdoIsCompletedAllTheSame) {
  const Commanded commanded = fresh();
  EXPECT_FALSE(commanded.is_supervised(torque_));
  EXPECT_EQ(commanded.rpdo_of(torque_), 1U);
  EXPECT_TRUE(commanded.values(1, all(kRun)));
}

}  // namespace
}  // namespace process::commanded
