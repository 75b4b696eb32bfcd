// When an RPDO that the node supervises is repeated, and with what.

#include <chrono>
#include <memory>
#include <tuple>
#include <vector>

#include "tests/unit/canopen/outputs_bench.h"

namespace canopen::outputs {
namespace {

using namespace std::chrono_literals;

TEST_F(OutputsTest, ARepetitionComesThreeTimesPerEventTimer) {
  run();
  loop_.advance(350ms);
  EXPECT_EQ(heard_, (std::vector<Heard>{{100ms, {15, 100}}, {200ms, {15, 100}}, {300ms, {15, 100}}}));
}

TEST_F(OutputsTest, WhatWasHeldBackFollowsAtOnceWithTheNewValue) {
  run();
  loop_.advance(95ms);
  const auto written = write(target(50), 20ms);
  loop_.advance(135ms);
  EXPECT_TRUE(*written);
  EXPECT_EQ(heard_, (std::vector<Heard>{{115ms, {15, 50}}, {215ms, {15, 50}}}));
}

TEST_F(OutputsTest, AWriteBetweenTwoRepetitionsAddsNone) {
  run();
  loop_.advance(20ms);
  const auto written = write(target(50), 20ms);
  loop_.advance(190ms);
  EXPECT_TRUE(*written);
  EXPECT_EQ(heard_, (std::vector<Heard>{{100ms, {15, 50}}, {200ms, {15, 50}}}));
}

TEST_F(OutputsTest, ARepetitionThatWaitsGivesWayToAWriteAndFollowsItAtOnce) {
  run();
  closed_ = true;
  loop_.advance(105ms);  // A repetition waits.
  const auto written = write(target(50), 2ms);
  loop_.advance(5ms);
  closed_ = false;
  loop_.advance(40ms);
  EXPECT_TRUE(*written);
  ASSERT_EQ(heard_.size(), 1U);
  EXPECT_EQ(heard_[0].second, (std::vector<int>{15, 50}));
}

TEST_F(OutputsTest, AWriteThatTakesLongHoldsBackForOnePeriod) {
  run();
  loop_.advance(90ms);
  const auto written = write(target(50), 175ms);
  for (int i = 0; i < 4; ++i) {
    loop_.advance(20ms);
    outputs_.hold(kTarget);  // Further writes wait behind it.
  }
  loop_.advance(130ms);
  EXPECT_TRUE(*written);
  // At 190 with the value of before: the drive would trip otherwise. So the new one is due again once it is confirmed.
  ASSERT_EQ(heard_.size(), 2U);
  EXPECT_EQ(heard_[0], (Heard{190ms, {15, 100}}));
  EXPECT_EQ(heard_[1], (Heard{265ms, {15, 50}}));
}

TEST_F(OutputsTest, ARefusedWriteHoldsBackForOnePeriod) {
  run();
  loop_.advance(90ms);
  outputs_.hold(kTarget);
  loop_.advance(220ms);
  EXPECT_EQ(heard_, (std::vector<Heard>{{190ms, {15, 100}}, {290ms, {15, 100}}}));
}

TEST_F(OutputsTest, NothingFollowsAWriteDuringWhichTheMotorFaulted) {
  run();
  loop_.advance(95ms);
  const auto written = write(target(50), 20ms);
  loop_.advance(10ms);
  image_.repeats = false;
  outputs_.look_again();
  loop_.advance(1s);
  EXPECT_TRUE(*written);
  EXPECT_TRUE(heard_.empty());
}

TEST_F(OutputsTest, NothingFollowsAWriteWhoseValueIsForgotten) {
  run();
  closed_ = true;
  loop_.advance(105ms);  // A repetition waits.
  outputs_.hold(kControl);
  image_.control.reset();
  outputs_.look_again();
  closed_ = false;
  loop_.advance(1s);
  EXPECT_TRUE(heard_.empty());
}

/// When writes begin beside the repetitions, how long the drive takes for one, how long nothing leaves before each.
class OutputsUnderWritesTest : public OutputsTest, public testing::WithParamInterface<std::tuple<int, int, int>> {};

TEST_P(OutputsUnderWritesTest, NoGapIsLongerThanTheEventTimer) {
  const auto [every, answer, blocked] = GetParam();
  run();
  Raw value = 0;
  std::shared_ptr<bool> writing;
  std::size_t writes = 0;
  for (int ms = 1; ms <= 2000; ++ms) {
    closed_ = ms % every >= every - blocked;
    if (ms % every == every - 1 && (!writing || *writing)) {
      value = (value + 1) % 200;
      writing = write(target(value), std::chrono::milliseconds(answer));
      ++writes;
    }
    loop_.advance(1ms);
  }
  EXPECT_GE(writes, 6U);
  EXPECT_LE(longest_gap(), kEventTimer - std::chrono::milliseconds(blocked));
  EXPECT_LE(longest_gap(), 2 * kPeriod + std::chrono::milliseconds(2 * blocked));
}

INSTANTIATE_TEST_SUITE_P(AtEachRepetition, OutputsUnderWritesTest,
                         testing::Combine(testing::Values(20, 33, 97, 99, 100, 101, 150),
                                          testing::Values(0, 2, 90, 250), testing::Values(0, 3, 10)));

TEST_F(OutputsTest, AWriteEachTimeARepetitionWaitsDoesNotStopIt) {
  run();
  for (int i = 0; i < 20; ++i) {
    // As others' commands do: the repetition waits, and a write is queued in front of it.
    const std::size_t before = heard_.size();
    closed_ = true;
    loop_.advance(i == 0 ? 101ms : 99ms);
    ASSERT_EQ(heard_.size(), before);
    const auto written = write(target(static_cast<Raw>(i)), 2ms);
    loop_.advance(1ms);
    closed_ = false;
    loop_.advance(40ms);  // The queue tries again after 32 ms at the latest.
    ASSERT_TRUE(*written);
    ASSERT_EQ(heard_.size(), before + 1);
    EXPECT_EQ(heard_.back().second, (std::vector<int>{15, i}));
  }
  EXPECT_LE(longest_gap(), 2 * kPeriod);
}

TEST_F(OutputsTest, ARepetitionThatWaitsWithWhatIsVoidGivesWay) {
  run();
  closed_ = true;
  loop_.advance(110ms);  // A repetition waits.
  image_.control = control(6);
  outputs_.look_again();
  closed_ = false;
  loop_.advance(140ms);
  ASSERT_EQ(heard_.size(), 2U);
  EXPECT_EQ(heard_[0].second, (std::vector<int>{6, 100}));
  EXPECT_EQ(heard_[1].second, (std::vector<int>{6, 100}));
}

TEST_F(OutputsTest, ARepetitionThatWaitsDoesNotLeaveWhereNothingIsRepeatedAnyMore) {
  run();
  closed_ = true;
  loop_.advance(110ms);  // A repetition waits.
  image_.repeats = false;
  outputs_.look_again();
  closed_ = false;
  loop_.advance(1s);
  EXPECT_TRUE(heard_.empty());
}

TEST_F(OutputsTest, TheImageIsAskedForEachRepetition) {
  run();
  loop_.advance(150ms);
  image_.control = control(6);
  loop_.advance(100ms);
  image_.target = target(7);
  loop_.advance(100ms);
  EXPECT_EQ(heard_, (std::vector<Heard>{{100ms, {15, 100}}, {200ms, {6, 100}}, {300ms, {6, 7}}}));
}

TEST_F(OutputsTest, AnImageThatLacksAFieldIsNotRepeated) {
  run();
  image_.control = target(15);  // An image that names one object twice has no value for the other.
  loop_.advance(1s);
  EXPECT_TRUE(heard_.empty());
}

TEST_F(OutputsTest, ACommandThatTheImageKeepsFromBeingRepeatedLeavesOnce) {
  run();
  closed_ = true;
  const Sent sent = send({control(6), target(0)});
  loop_.advance(10ms);
  image_.repeats = false;
  outputs_.look_again();
  closed_ = false;
  loop_.advance(1s);
  ASSERT_TRUE(sent.done());
  EXPECT_TRUE(sent.get().has_value());
  ASSERT_EQ(heard_.size(), 1U);
  EXPECT_EQ(heard_[0].second, (std::vector<int>{6, 0}));
}

TEST_F(OutputsTest, AfterAnEndTheNextOneThatLeavesIsRepeatedAgain) {
  run();
  outputs_.cease();
  loop_.advance(1s);
  ASSERT_TRUE(heard_.empty());
  const Sent sent = send({control(6), target(0)});
  loop_.advance(150ms);
  ASSERT_TRUE(sent.done());
  ASSERT_EQ(heard_.size(), 2U);
  EXPECT_EQ(heard_[1].second, (std::vector<int>{6, 0}));
}

TEST_F(OutputsTest, AnRpdoWhoseEchoIsMissingIsNotRepeated) {
  run();
  wire_.withhold_echoes(true);
  const Sent sent = send({control(6), target(100)}, 50ms);
  loop_.advance(50ms);
  ASSERT_TRUE(sent.done());
  EXPECT_TRUE(sent.get().error().outcome_unknown);
  wire_.withhold_echoes(false);
  // The bus takes motion again once something has left.
  const Frame read = make_frame(0x605, std::vector<std::uint8_t>(8, 0x40));
  const Ticket reading = bus_.send(TransmitClass::sdo, read, Clock::now() + 1s, [](Departure) {});
  loop_.advance(20ms);
  heard_.clear();
  loop_.advance(3s);
  EXPECT_TRUE(heard_.empty()) << "the image still has the one before, which might undo it";
}

}  // namespace
}  // namespace canopen::outputs
