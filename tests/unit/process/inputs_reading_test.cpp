// What inputs want read by SDO: polled objects, and TPDOs that do not come.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "tests/unit/process/inputs_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

TEST_F(InputsTest, PolledObjectsAreReadAtTheirOwnPollAndFreshForThree) {
  go_live();
  EXPECT_EQ(answer_reads(), (std::vector<canopen::ObjectAddress>{test::kTemperature, test::kLimit}));
  EXPECT_EQ(raw("module_temperature"), 315U);
  std::map<canopen::ObjectAddress, int> counts;
  for (int i = 0; i < 40; ++i) {
    pass(100ms);
    for (const auto& object : answer_reads()) {
      ++counts[object];
    }
  }
  EXPECT_EQ(counts[test::kTemperature], 10);
  EXPECT_EQ(counts[test::kLimit], 4);
  pass(1200ms);
  EXPECT_TRUE(fresh("module_temperature"));
  pass(1ms);
  EXPECT_FALSE(fresh("module_temperature"));
}

TEST_F(InputsTest, PolledValueOutlivesTheLossOfTheDriveOnlyByItsPolls) {
  go_live();
  static_cast<void>(answer_reads());
  inputs_->on_status(false, false, now_);
  EXPECT_EQ(inputs_->next_read_at(), TimePoint::max());
  EXPECT_TRUE(fresh("module_temperature"));
  pass(1201ms);
  EXPECT_FALSE(fresh("module_temperature"));
}

TEST_F(InputsTest, PollingGoesOnInPreOperational) {
  inputs_->on_status(true, false, now_);
  EXPECT_EQ(answer_reads().size(), 2U);
  EXPECT_TRUE(fresh("module_temperature"));
}

TEST_F(InputsTest, AnswerFromBeforeALossIsForgotten) {
  go_live();
  const auto job = inputs_->next_read(now_);
  ASSERT_TRUE(job);
  inputs_->on_status(false, false, now_);
  inputs_->on_status(true, true, now_);
  inputs_->on_read(*job, Raw{99}, now_, {});
  EXPECT_FALSE(fresh("module_temperature"));
  EXPECT_EQ(raw("module_temperature"), 0U);
}

TEST_F(InputsTest, AbsentObjectIsAskedForOnceAMinuteOnly) {
  objects_.erase(test::kTemperature);
  go_live();
  EXPECT_EQ(answer_reads().size(), 2U);
  int asked = 0;
  for (int i = 0; i < 590; ++i) {
    pass(100ms);
    for (const auto& object : answer_reads()) {
      asked += object == test::kTemperature ? 1 : 0;
    }
  }
  EXPECT_EQ(asked, 0);
  pass(1100ms);
  objects_[test::kTemperature] = 1;
  static_cast<void>(answer_reads());
  EXPECT_TRUE(fresh("module_temperature"));
}

TEST_F(InputsTest, ObjectThatDoesNotAnswerIsLeftAloneForAWhile) {
  // Each try keeps the channel for seconds, and commands wait behind it.
  go_live();
  canopen::Error silence;
  silence.kind = canopen::ErrorKind::timeout;
  const auto job = inputs_->next_read(now_);
  ASSERT_TRUE(job);
  inputs_->on_read(*job, silence, now_, {});
  for (int i = 0; i < 99; ++i) {
    pass(100ms);
    for (const auto& object : answer_reads()) {
      EXPECT_EQ(object, test::kLimit);
    }
  }
  pass(200ms);
  EXPECT_EQ(answer_reads()[0], test::kTemperature);
}

TEST_F(InputsTest, UnverifiedOverdueTpdoIsReadBySdoInOneGo) {
  verified_ = {2};
  objects_[test::kStatusWord] = 0x01;
  objects_[test::kOutput] = 1234;
  go_live();
  static_cast<void>(answer_reads());
  tpdo1(0);
  tpdo2(0);
  const auto end = now_ + 320ms;
  while (now_ < end) {
    pass(10ms);
    tpdo2(0);
  }
  EXPECT_FALSE(fresh("running"));
  values_.clear();
  EXPECT_EQ(answer_reads(), (std::vector<canopen::ObjectAddress>{test::kStatusWord, test::kOutput}));
  EXPECT_EQ(values_, std::vector<SourceId>{0});
  EXPECT_TRUE(fresh("running"));
  EXPECT_EQ(raw("output_frequency"), 1234U);
  EXPECT_TRUE(inputs_->problems().empty());
  // A second later again, and fresh in between.
  for (int i = 0; i < 30; ++i) {
    pass(100ms);
    tpdo2(0);
    static_cast<void>(answer_reads());
    EXPECT_TRUE(fresh("running"));
  }
  EXPECT_TRUE(inputs_->problems().empty());
}

TEST_F(InputsTest, UnverifiedTpdoWhoseObjectsDoNotAnswerIsAProblem) {
  verified_ = {2};
  objects_[test::kStatusWord] = 0x01;
  go_live();
  static_cast<void>(answer_reads());
  for (int i = 0; i < 60; ++i) {
    pass(10ms);
    tpdo2(0);
  }
  static_cast<void>(answer_reads());
  ASSERT_EQ(inputs_->problems().size(), 1U);
  EXPECT_NE(inputs_->problems()[0].text.find("TPDO1 is overdue and reading its objects failed"), std::string::npos);
  EXPECT_NE(inputs_->problems()[0].text.find("0x06020000"), std::string::npos);
  EXPECT_FALSE(fresh("running"));
}

TEST_F(InputsTest, ReadingEndsWhenTheTpdoComesInTimeAgain) {
  verified_ = {2};
  objects_[test::kStatusWord] = 0x01;
  objects_[test::kOutput] = 1234;
  go_live();
  pass(600ms);
  static_cast<void>(answer_reads());
  for (int i = 0; i < 8; ++i) {
    pass(100ms);
    tpdo1(1);
    tpdo2(0);
  }
  for (int i = 0; i < 30; ++i) {
    pass(100ms);
    tpdo1(1);
    tpdo2(0);
    for (const auto& object : answer_reads()) {
      EXPECT_NE(object, test::kStatusWord);
    }
  }
}

TEST_F(InputsTest, TpdoNowAndThenDoesNotMakeSubstitutedValuesStale) {
  verified_ = {2};
  objects_[test::kStatusWord] = 0x01;
  objects_[test::kOutput] = 1234;
  go_live();
  pass(600ms);
  static_cast<void>(answer_reads());
  stale_.clear();
  for (int i = 0; i < 50; ++i) {
    pass(100ms);
    tpdo2(0);
    if (i % 7 == 0) {
      tpdo1(1);
    }
    static_cast<void>(answer_reads());
    EXPECT_TRUE(fresh("running")) << i;
  }
  EXPECT_TRUE(stale_.empty());
}

}  // namespace
}  // namespace process
