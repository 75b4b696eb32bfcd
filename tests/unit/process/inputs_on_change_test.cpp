// TPDOs that come on change only: fresh without a period, read after the arrival.

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "tests/unit/process/inputs_fixture.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class OnChangeTest : public InputsTest {
 protected:
  OnChangeTest() {
    model_.node.tpdos[0].period = {};
    objects_[test::kStatusWord] = 0x01;
    objects_[test::kOutput] = 1234;
    build();
  }
};

TEST_F(OnChangeTest, FreshAsLongAsTheDriveIsOperational) {
  go_live();
  tpdo1(1);
  for (int i = 0; i < 100; ++i) {
    pass(1s);
    tpdo2(0);
  }
  EXPECT_TRUE(fresh("running"));
  inputs_->on_status(true, false, now_);
  EXPECT_FALSE(fresh("running"));
}

TEST_F(OnChangeTest, IsReadAfterArrivalWhereItHasNotCome) {
  go_live();
  EXPECT_EQ(answer_reads(), (std::vector<canopen::ObjectAddress>{test::kTemperature, test::kLimit}));
  pass(101ms);
  EXPECT_EQ(answer_reads(), (std::vector<canopen::ObjectAddress>{test::kStatusWord, test::kOutput}));
  EXPECT_TRUE(fresh("running"));
  pass(250ms);
  EXPECT_TRUE(answer_reads().empty());
}

TEST_F(OnChangeTest, IsNotReadWhereItHasCome) {
  go_live();
  static_cast<void>(answer_reads());
  pass(50ms);
  tpdo1(0x01);
  pass(300ms);
  EXPECT_TRUE(answer_reads().empty());
}

TEST_F(OnChangeTest, FrameDuringTheRoundWins) {
  go_live();
  static_cast<void>(answer_reads());
  pass(101ms);
  const auto first = inputs_->next_read(now_);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->object, test::kStatusWord);
  tpdo1(test::kFaultBit, 0, 1);
  inputs_->on_read(*first, Raw{0x01}, now_, {});
  EXPECT_EQ(raw("fault"), 1U);
  EXPECT_EQ(raw("output_frequency"), 1U);
  EXPECT_TRUE(answer_reads().empty());
}

TEST_F(OnChangeTest, ReadAgainAfterLeavingOperational) {
  go_live();
  tpdo1(1);
  inputs_->on_status(true, false, now_);
  inputs_->on_status(true, true, now_);
  EXPECT_FALSE(fresh("running"));
  static_cast<void>(answer_reads());
  pass(101ms);
  EXPECT_EQ(answer_reads().size(), 2U);
  EXPECT_TRUE(fresh("running"));
}

TEST_F(OnChangeTest, NotReadableIsAProblem) {
  objects_.erase(test::kOutput);
  go_live();
  pass(101ms);
  tpdo2(0);
  static_cast<void>(answer_reads());
  ASSERT_EQ(inputs_->problems().size(), 1U);
  EXPECT_NE(inputs_->problems()[0].text.find("TPDO1 has not come"), std::string::npos);
  tpdo1(0);
  EXPECT_TRUE(inputs_->problems().empty());
}

TEST_F(OnChangeTest, WatchedIsReadAtEachPoll) {
  go_live();
  tpdo1(1);
  static_cast<void>(answer_reads());
  inputs_->watch(0, true, now_);
  int rounds = 0;
  for (int i = 0; i < 30; ++i) {
    pass(100ms);
    for (const auto& object : answer_reads()) {
      rounds += object == test::kStatusWord ? 1 : 0;
    }
  }
  EXPECT_EQ(rounds, 3);
  inputs_->watch(0, false, now_);
  pass(1100ms);
  static_cast<void>(answer_reads());
  pass(2s);
  for (const auto& object : answer_reads()) {
    EXPECT_NE(object, test::kStatusWord);
  }
}

TEST_F(OnChangeTest, WatchedThatCannotBeReadIsToldAndStaysFresh) {
  go_live();
  tpdo1(1);
  static_cast<void>(answer_reads());
  objects_.erase(test::kStatusWord);
  inputs_->watch(0, true, now_);
  pass(1s);
  static_cast<void>(answer_reads());
  EXPECT_EQ(watch_failed_, std::vector<SourceId>{0});
  EXPECT_TRUE(fresh("running")) << "it would have told a change";
  inputs_->watch(0, false, now_);
  pass(61s);
  static_cast<void>(answer_reads());
  EXPECT_EQ(watch_failed_.size(), 1U);
}

TEST_F(OnChangeTest, LostFramesMakeTpdoValuesSuspectUntilRefreshed) {
  go_live();
  tpdo1(1);
  tpdo2(0);
  static_cast<void>(answer_reads());
  inputs_->on_frames_lost(now_);
  EXPECT_FALSE(fresh("running"));
  EXPECT_FALSE(fresh("fault_code"));
  EXPECT_TRUE(fresh("module_temperature"));
  EXPECT_EQ(stale_.size(), 2U);
  EXPECT_EQ(answer_reads(), (std::vector<canopen::ObjectAddress>{test::kStatusWord, test::kOutput}));
  EXPECT_TRUE(fresh("running"));
  tpdo2(0);
  EXPECT_TRUE(fresh("fault_code"));
}

}  // namespace
}  // namespace process
