// TPDO values on their way into the image, and their freshness.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "tests/unit/process/inputs_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

TEST_F(InputsTest, OneSourcePerTpdoAndPolledObject) {
  ASSERT_EQ(image_->sources().size(), 4U);
  EXPECT_EQ(image_->sources()[0].source, (config::Source{config::SourceKind::tpdo, 1}));
  EXPECT_EQ(image_->sources()[1].source, (config::Source{config::SourceKind::tpdo, 2}));
  EXPECT_EQ(image_->sources()[2].source, (config::Source{config::SourceKind::sdo, 0}));
  EXPECT_EQ(image_->source_of(signal("running")), image_->source_of(signal("status_word")));
  EXPECT_EQ(image_->source_of(signal("frequency_command")), nullptr);
  EXPECT_NE(image_->source_of(signal("upper_limit")), nullptr);
}

TEST_F(InputsTest, NothingIsFreshBeforeTheFirstValue) {
  go_live();
  EXPECT_FALSE(fresh("status_word"));
  EXPECT_EQ(raw("status_word"), 0U);
  EXPECT_FALSE(image_->all_fresh(now_));
}

TEST_F(InputsTest, OneTpdoIsToldOnceWithAllItsSignalsAndBooleans) {
  go_live();
  tpdo1(test::kRunningBit | test::kReverseBit, 77, 4997);
  EXPECT_EQ(values_, std::vector<SourceId>{0});
  EXPECT_EQ(raw("output_frequency"), 4997U);
  EXPECT_EQ(raw("running"), 1U);
  EXPECT_EQ(raw("reverse"), 1U);
  EXPECT_EQ(raw("fault"), 0U);
  const std::vector<SignalId> expected{signal("status_word"), signal("output_frequency"),
                                       signal("running"),     signal("reverse"),
                                       signal("fault"),       signal("warning")};
  EXPECT_EQ(inputs_->plans()[0].signals, expected);
}

TEST_F(InputsTest, BooleanIsTrueForEachListedCodeOfTheMaskedWord) {
  // Goodrive600: the low byte is a code; 1 forward running, 2 reverse running.
  auto& running = *model_.signals[signal("running")].derived;
  running.mask = 0xFF;
  running.values = {1, 2};
  build();
  go_live();
  for (const auto& [word, expected] : std::map<Raw, Raw>{{0x0101, 1}, {0x0102, 1}, {0x0103, 0}, {0x0100, 0}}) {
    tpdo1(word);
    EXPECT_EQ(raw("running"), expected) << word;
  }
}

TEST_F(InputsTest, BooleanOfTheSignLooksAtTheSignedWord) {
  // CiA 402: reverse is the sign of the actual velocity.
  model_.signals[signal("output_frequency")].type = canopen::DataType::i16;
  auto& reverse = *model_.signals[signal("reverse")].derived;
  reverse = config::Derived{signal("output_frequency"), 0, {}, true};
  build();
  go_live();
  tpdo1(0, 0, 0xFFFF);
  EXPECT_EQ(raw("output_frequency"), ~Raw{0});
  EXPECT_EQ(raw("reverse"), 1U);
  tpdo1(0, 0, 1);
  EXPECT_EQ(raw("reverse"), 0U);
}

TEST_F(InputsTest, CyclicTpdoIsFreshForThreePeriodsAndNotLonger) {
  go_live();
  tpdo1(1);
  pass(300ms);
  EXPECT_TRUE(fresh("running"));
  EXPECT_TRUE(stale_.empty());
  pass(1ms);
  EXPECT_FALSE(fresh("running"));
  EXPECT_EQ(stale_, std::vector<SourceId>{0});
}

TEST_F(InputsTest, StalenessIsToldOnceAndFreshnessOnlyByValues) {
  go_live();
  tpdo1(1);
  pass(2s);
  EXPECT_EQ(stale_.size(), 1U);
  tpdo1(1);
  EXPECT_TRUE(fresh("running"));
  EXPECT_EQ(stale_.size(), 1U);
}

TEST_F(InputsTest, NoTpdoValueIsFreshWhileOfflineOrNotOperational) {
  go_live();
  tpdo1(1);
  inputs_->on_status(true, false, now_);
  EXPECT_FALSE(fresh("running"));
  EXPECT_EQ(stale_, std::vector<SourceId>{0});
  tpdo1(1);  // Whatever still arrives.
  EXPECT_FALSE(fresh("running"));
  inputs_->on_status(true, true, now_);
  EXPECT_FALSE(fresh("running"));
  tpdo1(1);
  EXPECT_TRUE(fresh("running"));
  inputs_->on_status(false, false, now_);
  EXPECT_FALSE(fresh("running"));
}

TEST_F(InputsTest, BootUpMakesEverySourceNotReceived) {
  go_live();
  tpdo1(1);
  static_cast<void>(answer_reads());
  ASSERT_TRUE(fresh("module_temperature"));
  inputs_->on_boot_up();
  EXPECT_FALSE(fresh("running"));
  EXPECT_FALSE(fresh("module_temperature"));
  for (const SourceState& source : image_->sources()) {
    EXPECT_FALSE(source.received);
  }
}

TEST_F(InputsTest, OverdueTpdoIsAProblemWithItsNumberWhileTheDriveLives) {
  go_live();
  tpdo1(1);
  tpdo2(0);
  for (int i = 0; i < 10; ++i) {
    pass(50ms);
    tpdo1(1);
  }
  EXPECT_EQ(inputs_->problems(), Problems({{alarms::DataReason::overdue, "TPDO2 is overdue"}}));
  tpdo2(0);
  EXPECT_TRUE(inputs_->problems().empty());
  EXPECT_EQ(problems_told_, 2);
  pass(400ms);
  EXPECT_FALSE(inputs_->problems().empty());
  inputs_->on_status(false, false, now_);
  EXPECT_TRUE(inputs_->problems().empty());
}

TEST_F(InputsTest, TpdoThatNeverComesIsOverdueToo) {
  go_live();
  pass(499ms);
  EXPECT_TRUE(inputs_->problems().empty());
  pass(2ms);
  EXPECT_EQ(inputs_->problems().size(), 2U);
}

TEST_F(InputsTest, ShorterTpdoIsToldUntilARightOneComes) {
  go_live();
  for (int i = 0; i < 5; ++i) {
    inputs_->on_tpdo_length(1, 6, 4, now_);
  }
  EXPECT_EQ(inputs_->problems(),
            Problems({{alarms::DataReason::too_short, "TPDO1 has 4 bytes, expected 6, and is not decoded"}}));
  EXPECT_EQ(problems_told_, 1);
  EXPECT_FALSE(fresh("running"));
  EXPECT_TRUE(remarks_.empty());
  tpdo1(1);
  EXPECT_TRUE(inputs_->problems().empty());
}

TEST_F(InputsTest, LongerTpdoIsRemarkedOnceAndItsValuesAreFresh) {
  go_live();
  for (int i = 0; i < 5; ++i) {
    pass(100ms);
    inputs_->on_tpdo_length(1, 6, 8, now_);
    tpdo1(1);
    EXPECT_TRUE(fresh("running"));
  }
  inputs_->on_boot_up();
  inputs_->on_tpdo_length(1, 6, 8, now_);
  EXPECT_EQ(remarks_, std::vector<std::string>{"TPDO1 has 8 bytes, expected 6; the first ones count"});
  inputs_->on_tpdo_length(2, 2, 8, now_);
  EXPECT_EQ(remarks_.size(), 2U) << "one of each TPDO";
  EXPECT_EQ(problems_told_, 0);
}

}  // namespace
}  // namespace process
