// Objects that a drive does not have: told by name, asked for rarely, and nobody waits for them.

#include <gtest/gtest.h>

#include "tests/unit/process/inputs_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;
using alarms::DataReason;

constexpr std::uint32_t kNoObject = 0x06020000;
constexpr std::uint32_t kNoSubIndex = 0x06090011;
constexpr SourceId kTemperatureSource = 2;

class AbsentObjectTest : public InputsTest {
 protected:
  static canopen::Error refusal(std::uint32_t abort) {
    canopen::Error error;
    error.kind = canopen::ErrorKind::refused;
    error.abort = abort;
    return error;
  }
  static canopen::Error silence() {
    canopen::Error error;
    error.kind = canopen::ErrorKind::timeout;
    return error;
  }
  // Answers the read of the temperature that is due; others get their value.
  void answer_temperature(const canopen::Result<Raw>& answer) {
    while (const auto job = inputs_->next_read(now_)) {
      inputs_->on_read(*job, job->object == test::kTemperature ? answer : canopen::Result<Raw>(Raw{1}), now_, {});
    }
  }
  // TPDOs come and reads are answered, but that of the temperature.
  void live(Duration time, const canopen::Result<Raw>& answer) {
    for (const TimePoint end = now_ + time; now_ < end;) {
      pass(50ms);
      tpdo1(1);
      tpdo2(0);
      answer_temperature(answer);
    }
  }
  [[nodiscard]] bool absent(std::string_view name) const { return image_->absent(signal(name)); }
};

TEST_F(AbsentObjectTest, IsNamedNeverFreshAndNobodyWaitsForIt) {
  go_live();
  live(200ms, refusal(kNoObject));
  EXPECT_EQ(inputs_->problems(),
            Problems({{DataReason::absent, "the drive has no object 0x2021:0D (module_temperature)"}}));
  EXPECT_TRUE(absent("module_temperature"));
  EXPECT_FALSE(fresh("module_temperature"));
  EXPECT_FALSE(absent("upper_limit"));
  EXPECT_TRUE(image_->all_fresh(now_));
  EXPECT_EQ(presence_, std::vector<SourceId>{kTemperatureSource});
  live(59s, refusal(kNoObject));
  EXPECT_TRUE(image_->all_fresh(now_));
  EXPECT_EQ(presence_.size(), 1U);
}

TEST_F(AbsentObjectTest, ASubIndexCountsToo) {
  go_live();
  live(200ms, refusal(kNoSubIndex));
  EXPECT_TRUE(absent("module_temperature"));
}

TEST_F(AbsentObjectTest, OtherFailuresAreWaitedFor) {
  for (const canopen::Error& error : {silence(), refusal(0x08000000), refusal(0x06010001), refusal(0x08000024)}) {
    build();
    go_live();
    live(200ms, error);
    EXPECT_FALSE(absent("module_temperature")) << to_string(error);
    EXPECT_FALSE(image_->all_fresh(now_)) << to_string(error);
    EXPECT_TRUE(inputs_->problems().empty()) << to_string(error);
  }
}

TEST_F(AbsentObjectTest, ThatVanishesShowsNoValueAnyMore) {
  go_live();
  live(200ms, Raw{315});
  ASSERT_TRUE(fresh("module_temperature"));
  live(500ms, refusal(kNoObject));
  EXPECT_FALSE(fresh("module_temperature"));
  EXPECT_EQ(raw("module_temperature"), 0U);
  EXPECT_EQ(stale_, std::vector<SourceId>{kTemperatureSource});
}

TEST_F(AbsentObjectTest, ItsBitsAreNotSetWhateverZeroWouldMean) {
  config::Signal cold = test::bit("cold", 3, 0xFF);
  cold.derived->values = {0};
  model_.signals.push_back(cold);
  build();
  go_live();
  live(200ms, Raw{0});
  ASSERT_EQ(raw("cold"), 1U);
  live(500ms, refusal(kNoObject));
  EXPECT_EQ(raw("cold"), 0U);
  EXPECT_TRUE(absent("cold"));
}

TEST_F(AbsentObjectTest, IsAskedForAnewWhenTheDriveComesAgain) {
  go_live();
  live(200ms, refusal(kNoObject));
  inputs_->on_boot_up();
  inputs_->on_status(false, false, now_);
  // What is known of it stands until it was asked again: nothing is told to be over while nobody knows.
  EXPECT_EQ(inputs_->problems().size(), 1U);
  pass(1s);
  go_live();
  live(200ms, Raw{315});
  EXPECT_TRUE(inputs_->problems().empty());
  EXPECT_TRUE(fresh("module_temperature"));
  EXPECT_TRUE(image_->all_fresh(now_));
}

TEST_F(AbsentObjectTest, AppearsWithinAMinute) {
  go_live();
  live(200ms, refusal(kNoObject));
  live(61s, Raw{315});
  EXPECT_TRUE(fresh("module_temperature"));
  EXPECT_TRUE(inputs_->problems().empty());
}

TEST_F(AbsentObjectTest, SilenceIsNoProofOfEither) {
  go_live();
  live(200ms, refusal(kNoObject));
  live(61s, silence());
  EXPECT_TRUE(absent("module_temperature"));
  live(61s, refusal(0x08000024));  // No data: it is there.
  EXPECT_FALSE(absent("module_temperature"));
  EXPECT_FALSE(image_->all_fresh(now_));
  EXPECT_TRUE(inputs_->problems().empty());
  EXPECT_EQ(presence_.size(), 2U);
}

TEST_F(AbsentObjectTest, ADriveThatHasNoneOfThemShowsNothingFresh) {
  model_.signals = {model_.signals[3]};
  model_.faults = {};
  build();
  go_live();
  live(200ms, refusal(kNoObject));
  EXPECT_TRUE(absent("module_temperature"));
  EXPECT_FALSE(image_->all_fresh(now_));
}

TEST_F(AbsentObjectTest, ThatATpdoCarriesIsNoMatter) {
  model_.node.tpdos[0].period = {};
  build();
  go_live();
  tpdo1(1);
  inputs_->watch(0, true, now_);
  pass(1100ms);
  tpdo2(0);
  while (const auto job = inputs_->next_read(now_)) {
    const bool polled = job->object == test::kTemperature || job->object == test::kLimit;
    inputs_->on_read(*job, polled ? canopen::Result<Raw>(Raw{1}) : refusal(kNoObject), now_, {});
  }
  EXPECT_TRUE(fresh("running"));
  EXPECT_FALSE(absent("running"));
  for (const alarms::DataProblem& problem : inputs_->problems()) {
    EXPECT_EQ(problem.text.find("TPDO1"), std::string::npos) << problem.text;
  }
}

TEST_F(AbsentObjectTest, TheDriveIsExaminedOnceEverySourceHasTold) {
  EXPECT_FALSE(inputs_->examined());
  go_live();
  tpdo1(1);
  EXPECT_FALSE(inputs_->examined());
  tpdo2(0);
  answer_temperature(silence());
  EXPECT_FALSE(inputs_->examined()) << "no answer is no proof";
  EXPECT_EQ(problems_told_, 0);
  live(11s, Raw{1});
  EXPECT_TRUE(inputs_->examined());
  EXPECT_EQ(problems_told_, 1);
  inputs_->on_status(false, false, now_);
  EXPECT_FALSE(inputs_->examined());
}

TEST_F(AbsentObjectTest, WhatIsNotOperationalSendsNoTpdoToWaitFor) {
  inputs_->on_status(true, false, now_);
  answer_temperature(Raw{1});
  EXPECT_TRUE(inputs_->examined());
}

class ShortTpdoTest : public AbsentObjectTest {
 protected:
  ShortTpdoTest() {
    model_.node.tpdos[0].period = {};  // On change.
    objects_[test::kStatusWord] = test::kFaultBit;
    objects_[test::kOutput] = 1234;
    build();
    go_live();
    tpdo1(1);
    tpdo2(0);
    static_cast<void>(answer_reads());
  }
};

TEST_F(ShortTpdoTest, OnChangeIsReadForWhatItWouldHaveTold) {
  ASSERT_TRUE(fresh("fault"));
  inputs_->on_tpdo_length(1, 6, 4, now_);
  EXPECT_FALSE(fresh("fault")) << "it told a change that nobody knows";
  static_cast<void>(answer_reads());
  EXPECT_TRUE(fresh("fault"));
  EXPECT_EQ(raw("fault"), 1U);
  ASSERT_EQ(inputs_->problems().size(), 1U);
  EXPECT_EQ(inputs_->problems()[0].reason, DataReason::too_short);
  // And from then on at each poll, for the next short one tells no more.
  objects_[test::kStatusWord] = 0;
  for (int i = 0; i < 12; ++i) {
    pass(100ms);
    tpdo2(0);
    inputs_->on_tpdo_length(1, 6, 4, now_);
    static_cast<void>(answer_reads());
    EXPECT_TRUE(fresh("fault"));
  }
  EXPECT_EQ(raw("fault"), 0U);
}

TEST_F(ShortTpdoTest, ReadValuesGoStaleWhenNobodyAnswers) {
  inputs_->on_tpdo_length(1, 6, 4, now_);
  static_cast<void>(answer_reads());
  ASSERT_TRUE(fresh("fault"));
  pass(3100ms);
  EXPECT_FALSE(fresh("fault"));
}

TEST_F(ShortTpdoTest, OfTheRightLengthEndsIt) {
  inputs_->on_tpdo_length(1, 6, 4, now_);
  static_cast<void>(answer_reads());
  tpdo1(1);
  EXPECT_TRUE(inputs_->problems().empty());
  pass(10s);
  EXPECT_TRUE(fresh("fault"));
  for (const auto& object : answer_reads()) {
    EXPECT_NE(object, test::kStatusWord);
  }
}

}  // namespace
}  // namespace process
