// RPDOs that somebody sends: what they carry, and what is withdrawn.

#include <chrono>
#include <variant>
#include <vector>

#include "tests/unit/canopen/outputs_bench.h"

namespace canopen::outputs {
namespace {

using namespace std::chrono_literals;

TEST_F(OutputsTest, AWithdrawnRpdoNeverLeavesAndTheRepetitionGoesOnWithWhatTheImageSaysNow) {
  run();
  closed_ = true;
  loop_.advance(50ms);
  const Sent sent = send({control(15), target(50)});
  loop_.advance(100ms);  // A repetition was due meanwhile.
  image_.control = control(6);
  outputs_.withdraw();
  outputs_.look_again();
  loop_.settle();
  ASSERT_TRUE(sent.done());
  EXPECT_EQ(sent.get().error().kind, ErrorKind::timeout);
  EXPECT_TRUE(sent.get().error().not_sent);
  EXPECT_FALSE(sent.get().error().outcome_unknown);
  EXPECT_EQ(sent.get().error().node, kNode);
  closed_ = false;
  loop_.advance(40ms);
  ASSERT_EQ(heard_.size(), 1U);
  EXPECT_EQ(heard_[0].second, (std::vector<int>{6, 100}));
}

TEST_F(OutputsTest, NoRepetitionOfTheSameRpdoLeavesBesideACommandThatWaits) {
  run();
  closed_ = true;
  loop_.advance(105ms);  // A repetition waits.
  const Sent sent = send({control(6), target(0)});
  loop_.advance(250ms);  // Two more were due.
  closed_ = false;
  loop_.advance(140ms);
  ASSERT_TRUE(sent.done());
  EXPECT_TRUE(sent.get().has_value());
  ASSERT_EQ(heard_.size(), 2U);
  EXPECT_EQ(heard_[0].second, (std::vector<int>{6, 0}));
  EXPECT_EQ(heard_[1].second, (std::vector<int>{6, 0}));
  EXPECT_EQ(heard_[1].first - heard_[0].first, kPeriod);
}

TEST_F(OutputsTest, ACommandThatDoesNotLeaveInTimeTimedOutAndTheRepetitionGoesOn) {
  run();
  closed_ = true;
  const Sent sent = send({control(6), target(0)}, 50ms);
  loop_.advance(60ms);
  ASSERT_TRUE(sent.done());
  EXPECT_EQ(sent.get().error().kind, ErrorKind::timeout);
  EXPECT_FALSE(sent.get().error().outcome_unknown);
  closed_ = false;
  loop_.advance(150ms);
  ASSERT_FALSE(heard_.empty());
  EXPECT_EQ(heard_[0], (Heard{100ms, {15, 100}}));
}

TEST_F(OutputsTest, AStopLeavesBeforeACommandThatWaits) {
  run();
  closed_ = true;
  const Sent command = send({control(15), target(50)});
  loop_.settle();
  const Sent stop = send({control(6), target(100)}, 800ms, TransmitClass::stop);
  loop_.advance(10ms);
  closed_ = false;
  loop_.advance(40ms);
  ASSERT_TRUE(command.done() && stop.done());
  EXPECT_TRUE(stop.get().has_value());
  ASSERT_FALSE(heard_.empty());
  EXPECT_EQ(heard_[0].second, (std::vector<int>{6, 100}));
}

TEST_F(OutputsTest, AnEndWithdrawsAllThatWaits) {
  run();
  closed_ = true;
  const Sent first = send({control(15), target(50)});
  const Sent second = send({control(6), target(0)});
  loop_.advance(10ms);
  outputs_.cease();
  loop_.settle();
  ASSERT_TRUE(first.done() && second.done());
  for (const Sent& sent : {first, second}) {
    EXPECT_EQ(sent.get().error().kind, ErrorKind::offline);
    EXPECT_TRUE(sent.get().error().not_sent);
    EXPECT_FALSE(sent.get().error().outcome_unknown);
    EXPECT_EQ(sent.get().error().node, kNode);
  }
  closed_ = false;
  loop_.advance(1s);
  EXPECT_TRUE(heard_.empty()) << "whatever the image says";
}

TEST_F(OutputsTest, WhatIsNotExactlyItsFieldsIsIncompleteAndNothingLeaves) {
  const std::vector<Outputs::Values> wrong{
      {}, {target(50)}, {control(15)}, {control(15), target(50), {{0x6060, 0}, DataType::i8, 2}}};
  for (const Outputs::Values& values : wrong) {
    const Sent sent = send(values);
    loop_.settle();
    ASSERT_TRUE(sent.done());
    EXPECT_EQ(sent.get().error().kind, ErrorKind::incomplete);
    EXPECT_EQ(sent.get().error().node, kNode);
  }
  loop_.advance(1s);
  EXPECT_TRUE(heard_.empty());
}

/// RPDOs that are not repeated: what their fields carry.
class OutputsFieldsTest : public OutputsTest {
 protected:
  /// What is on the wire of one RPDO with these fields; the error's kind where it does not leave.
  std::variant<std::vector<int>, ErrorKind> sent(std::vector<MappedObject> mapping, Outputs::Values values,
                                                 std::uint16_t number = 1) {
    const std::vector<PdoSettings> settings{{.cob_id = 0x205, .mapping = std::move(mapping)}};
    Outputs outputs(loop_.executor(), bus_, kNode, settings, [](std::uint16_t) { return std::nullopt; });
    std::vector<int> bytes;
    const Subscription rpdos = drive_.subscribe(0x205, [&](const Received& received) {
      bytes.assign(received.frame.bytes().begin(), received.frame.bytes().end());
    });
    const Sent result = support::spawn(
        loop_.executor(), outputs.send(number, std::move(values), TransmitClass::command, Clock::now() + 50ms));
    loop_.settle();
    EXPECT_TRUE(result.done());
    if (result.get().has_error()) {
      EXPECT_TRUE(bytes.empty());
      return result.get().error().kind;
    }
    return bytes;
  }
  using Bytes = std::vector<int>;
};

TEST_F(OutputsFieldsTest, FieldsStandWhereTheyAreMapped) {
  EXPECT_EQ(std::get<Bytes>(sent({{kControl}, {kTarget}}, {target(0x1234), control(15)})),
            (Bytes{0x0F, 0x00, 0x34, 0x12}));
}

TEST_F(OutputsFieldsTest, UnusedFieldsAreZeroAndTakeNoValue) {
  const std::vector<MappedObject> mapping{{kControl}, {kTarget, DataType::u16, 16, FieldUse::unused}};
  EXPECT_EQ(std::get<Bytes>(sent(mapping, {control(15)})), (Bytes{0x0F, 0x00, 0x00, 0x00}));
  EXPECT_EQ(std::get<ErrorKind>(sent(mapping, {control(15), target(9)})), ErrorKind::incomplete);
}

TEST_F(OutputsFieldsTest, AGapIsZero) {
  EXPECT_EQ(std::get<Bytes>(sent({{{0x0006, 0}}, {kControl}}, {control(15)})), (Bytes{0x00, 0x00, 0x0F, 0x00}));
}

TEST_F(OutputsFieldsTest, AFieldThatNobodyNamedKeepsItFromBeingSent) {
  const std::vector<MappedObject> mapping{{kControl}, {kTarget, DataType::u16, 16, FieldUse::unnamed}};
  EXPECT_EQ(std::get<ErrorKind>(sent(mapping, {control(15)})), ErrorKind::incomplete);
  EXPECT_EQ(std::get<ErrorKind>(sent(mapping, {control(15), target(9)})), ErrorKind::incomplete);
}

TEST_F(OutputsFieldsTest, AnEmptyMappingIsNeverSent) {
  EXPECT_EQ(std::get<ErrorKind>(sent({}, {})), ErrorKind::incomplete);
}

TEST_F(OutputsFieldsTest, AnotherNumberIsUnknown) {
  EXPECT_EQ(std::get<ErrorKind>(sent({{kControl}}, {control(15)}, 2)), ErrorKind::unknown);
}

}  // namespace
}  // namespace canopen::outputs
