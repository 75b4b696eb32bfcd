#include "bridges/process/inputs.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/process/test_drive.h"

namespace process {
namespace {

using canopen::Duration;
using canopen::Raw;
using canopen::TimePoint;
using namespace std::chrono_literals;

class InputsTest : public ::testing::Test, public Inputs::Listener {
 protected:
  InputsTest() { build(); }

  void build() {
    image_ = std::make_unique<Image>(model_);
    inputs_ = std::make_unique<Inputs>(
        model_, *image_, [this](std::uint16_t tpdo) { return verified_.contains(tpdo); }, *this);
    values_.clear();
    stale_.clear();
  }

  void go_live() { inputs_->on_status(true, true, now_); }

  void tpdo1(Raw status, Raw current = 0, Raw frequency = 0) {
    inputs_->on_tpdo(1, std::vector<Raw>{status, current, frequency}, now_, {});
  }
  void tpdo2(Raw fault_code) { inputs_->on_tpdo(2, std::vector<Raw>{fault_code}, now_, {}); }

  // Time passes in small steps, so that nothing fires late.
  void pass(Duration time) {
    for (const TimePoint end = now_ + time; now_ < end;) {
      now_ += 1ms;
      if (now_ >= inputs_->next_expiry()) {
        inputs_->expire(now_);
      }
    }
  }

  // Answers every read that is due; returns the objects in the order they were asked for.
  std::vector<canopen::ObjectAddress> answer_reads() {
    std::vector<canopen::ObjectAddress> asked;
    while (const auto job = inputs_->next_read(now_)) {
      asked.push_back(job->object);
      const auto known = objects_.find(job->object);
      if (known != objects_.end()) {
        inputs_->on_read(*job, known->second, now_, {});
      } else {
        canopen::Error absent;
        absent.kind = canopen::ErrorKind::refused;
        absent.abort = 0x06020000;
        inputs_->on_read(*job, absent, now_, {});
      }
      if (asked.size() > 100) {
        ADD_FAILURE() << "reading does not end";
        break;
      }
    }
    return asked;
  }

  [[nodiscard]] SignalId signal(std::string_view name) const { return test::id(model_, name); }
  [[nodiscard]] bool fresh(std::string_view name) const { return image_->fresh(signal(name), now_); }
  [[nodiscard]] Raw raw(std::string_view name) const { return image_->raw(signal(name)); }

  void on_values(SourceId source) override { values_.push_back(source); }
  void on_stale(SourceId source) override { stale_.push_back(source); }
  void on_problems() override { ++problems_told_; }
  void on_read_wanted() override { ++reads_wanted_; }

  config::Drive model_ = test::drive();
  std::set<std::uint16_t> verified_{1, 2};
  std::map<canopen::ObjectAddress, Raw> objects_{{test::kTemperature, 315}, {test::kLimit, 5000}};
  std::unique_ptr<Image> image_;
  std::unique_ptr<Inputs> inputs_;
  TimePoint now_{1h};
  std::vector<SourceId> values_;
  std::vector<SourceId> stale_;
  int problems_told_ = 0;
  int reads_wanted_ = 0;
};

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

TEST_F(InputsTest, OverdueTpdoIsAProblemWithItsNumberWhileTheDriveLives) {
  go_live();
  tpdo1(1);
  tpdo2(0);
  for (int i = 0; i < 10; ++i) {
    pass(50ms);
    tpdo1(1);
  }
  EXPECT_EQ(inputs_->problems(), std::vector<std::string>{"TPDO2 is overdue"});
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

TEST_F(InputsTest, TpdoOfAnotherLengthIsToldUntilARightOneComes) {
  go_live();
  for (int i = 0; i < 5; ++i) {
    inputs_->on_tpdo_length(1, 6, 8);
  }
  EXPECT_EQ(inputs_->problems(), std::vector<std::string>{"TPDO1 has 8 bytes, expected 6, and is not decoded"});
  EXPECT_EQ(problems_told_, 1);
  EXPECT_FALSE(fresh("running"));
  tpdo1(1);
  EXPECT_TRUE(inputs_->problems().empty());
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
  EXPECT_NE(inputs_->problems()[0].find("TPDO1 is overdue and reading its objects failed"), std::string::npos);
  EXPECT_NE(inputs_->problems()[0].find("0x06020000"), std::string::npos);
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
  EXPECT_NE(inputs_->problems()[0].find("TPDO1 has not come"), std::string::npos);
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
