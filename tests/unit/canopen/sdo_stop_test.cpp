// Stops by SDO go before everything else, however slow the drive is.

#include <vector>

#include "tests/unit/canopen/sdo_stop_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SdoStopTest : public SdoStopBench {};

TEST_F(SdoStopTest, AmongSetPointsOfASlowDriveNoneIsLost) {
  for (const Duration later : {0ms, 1ms, 50ms, 99ms}) {
    slave_.forget_heard();
    serve_slowly(100ms, 100ms);
    const auto under_way = command(kSetPoint, 100);
    loop_.advance(later);
    const auto waiting = command(kSetPoint, 200);
    const auto stopping = stop();
    const TimePoint given = Clock::now();
    expect_on_the_wire_within(150ms);
    ASSERT_TRUE(loop_.advance_until([&] { return stopping.done(); }, 300ms));
    EXPECT_LE(Clock::now() - given, 300ms);
    EXPECT_TRUE(stopping.get().has_value()) << to_string(stopping.get().error());
    ASSERT_TRUE(under_way.done());
    EXPECT_TRUE(under_way.get().has_value()) << to_string(under_way.get().error());
    loop_.advance(200ms);
    ASSERT_TRUE(waiting.done());
    EXPECT_TRUE(waiting.get().has_value()) << "it goes on behind the stop";
    EXPECT_EQ(stops_heard(), 1);
  }
}

TEST_F(SdoStopTest, BesideASettingThatIsWrittenToFlash) {
  serve_slowly(5ms, 700ms);
  const auto setting = write(kSetPoint, DataType::u16, 7);
  loop_.advance(10ms);
  serve_slowly(5ms, 5ms);
  const auto stopping = stop(900ms);
  expect_on_the_wire_within(150ms);
  loop_.advance(650ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value()) << to_string(stopping.get().error());
  loop_.advance(100ms);
  ASSERT_TRUE(setting.done()) << "tried again";
  EXPECT_TRUE(setting.get().has_value());
  EXPECT_EQ(slave_.value(kCommand), kHalt);
}

TEST_F(SdoStopTest, BesideACommandThatIsNeverAnswered) {
  slave_.mute(kSetPoint);
  const auto setpoint = command(kSetPoint, 7);
  loop_.advance(10ms);
  const auto stopping = stop();
  expect_on_the_wire_within(150ms);
  loop_.advance(2ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
  expect_unknown(setpoint, ErrorKind::timeout, "no answer in 111 ms, and a stop goes first");
}

TEST_F(SdoStopTest, HoweverLittleTimeIsLeft) {
  slave_.mute(kSetPoint);
  const auto setpoint = command(kSetPoint, 7);
  loop_.advance(10ms);
  const auto stopping = stop(20ms);
  expect_on_the_wire_within(15ms);
  EXPECT_EQ(slave_.reads().size(), 0U);
}

TEST_F(SdoStopTest, AReadUnderWayIsTriedAgainWithoutUsingUpATry) {
  use({.retries = 0});
  slave_.mute(kStatus);
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(10ms);
  const auto stopping = stop();
  loop_.advance(110ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
  EXPECT_FALSE(reading.done());
  loop_.advance(600ms);
  ASSERT_TRUE(reading.done()) << "the try that it has is used up";
  EXPECT_EQ(reading.get().error().kind, ErrorKind::timeout);
  EXPECT_EQ(slave_.reads(), (std::vector<ObjectAddress>{kStatus, kStatus}));
}

TEST_F(SdoStopTest, WhatHasNotLeftIsWithdrawnAtOnce) {
  slave_.set(kStatus, DataType::u16, 3);
  closed_ = true;
  const auto setpoint = command(kSetPoint, 7);
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(1ms);
  const auto stopping = stop();
  loop_.advance(1ms);
  ASSERT_TRUE(setpoint.done());
  EXPECT_EQ(setpoint.get().error().kind, ErrorKind::timeout);
  EXPECT_TRUE(setpoint.get().error().not_sent);
  EXPECT_FALSE(setpoint.get().error().outcome_unknown);
  EXPECT_NE(setpoint.get().error().detail.find("a stop goes first"), std::string::npos);
  closed_ = false;
  loop_.advance(50ms);
  ASSERT_TRUE(stopping.done() && reading.done());
  EXPECT_TRUE(stopping.get().has_value());
  EXPECT_TRUE(reading.get().has_value());
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kCommand});
}

TEST_F(SdoStopTest, ACommandThatStillWaitsForAProofIsNotSent) {
  slave_.mute_sdo(true);
  const auto silent = command(kSetPoint, 1, 100ms);
  loop_.advance(101ms);
  const auto setpoint = command(kSetPoint, 2);
  loop_.advance(10ms);
  ASSERT_EQ(slave_.reads(), std::vector<ObjectAddress>{(ObjectAddress{0x1000, 0})});
  const auto stopping = stop();
  expect_on_the_wire_within(150ms);
  ASSERT_TRUE(setpoint.done());
  EXPECT_TRUE(setpoint.get().error().not_sent);
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{kSetPoint, kCommand}));
}

TEST_F(SdoStopTest, ALongUploadGivesWayAtItsNextAnswer) {
  slave_.set_bytes(kName, Bytes(250, 1));
  slave_.delay_answers(30ms);
  const auto reading = read(kName, DataType::u64);
  loop_.advance(100ms);
  const auto stopping = stop();
  expect_on_the_wire_within(31ms);
  loop_.advance(31ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
  ASSERT_TRUE(loop_.advance_until([&] { return reading.done(); }, 2s));
  EXPECT_TRUE(reading.get().has_value());
}

TEST_F(SdoStopTest, OfTwoTheFirstGoesFirst) {
  slave_.delay_answers(50ms);
  const auto first = stop();
  const auto second =
      support::spawn(loop_.executor(), client_->write_stop(kCommand, DataType::u16, 6, Clock::now() + 800ms));
  loop_.advance(60ms);
  ASSERT_TRUE(first.done());
  EXPECT_TRUE(first.get().has_value());
  EXPECT_FALSE(second.done());
  loop_.advance(60ms);
  ASSERT_TRUE(second.done());
  EXPECT_TRUE(second.get().has_value());
  EXPECT_EQ(slave_.value(kCommand), 6U);
}

TEST_F(SdoStopTest, TheEndOfALifeLosesNoneThatHasNotLeft) {
  slave_.mute(kStatus);
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(10ms);
  const auto in_line = stop();
  loop_.advance(10ms);
  client_->interrupt();
  loop_.advance(5ms);
  ASSERT_TRUE(reading.done() && in_line.done());
  EXPECT_TRUE(in_line.get().has_value());

  closed_ = true;
  const auto in_queue = stop();
  loop_.advance(10ms);
  client_->interrupt();
  client_->withdraw_commands();
  loop_.advance(10ms);
  EXPECT_FALSE(in_queue.done());
  closed_ = false;
  loop_.advance(40ms);
  ASSERT_TRUE(in_queue.done());
  EXPECT_TRUE(in_queue.get().has_value());
  EXPECT_EQ(stops_heard(), 2);
}

TEST_F(SdoStopTest, OneThatHasLeftIsUnknownAtTheEndOfALife) {
  slave_.mute(kCommand);
  const auto stopping = stop();
  loop_.advance(10ms);
  client_->withdraw_commands();
  loop_.advance(1ms);
  EXPECT_FALSE(stopping.done()) << "leaving operational ends no stop";
  client_->interrupt();
  loop_.advance(1ms);
  expect_unknown(stopping, ErrorKind::offline, "sent, not confirmed");
}

TEST_F(SdoStopTest, TheEndOfTheClientCallsStopsOffAndSendsNothing) {
  slave_.mute(kStatus);
  closed_ = true;
  const auto in_queue = stop();
  const auto in_line = stop();
  loop_.advance(10ms);
  client_->close();
  closed_ = false;
  loop_.advance(100ms);
  for (const auto& stopping : {in_queue, in_line}) {
    ASSERT_TRUE(stopping.done());
    EXPECT_EQ(stopping.get().error().kind, ErrorKind::offline);
    EXPECT_TRUE(stopping.get().error().not_sent);
    EXPECT_FALSE(stopping.get().error().outcome_unknown);
  }
  EXPECT_EQ(stops_heard(), 0);
}

// Another node's SDO request of ours waits for its echo: the abort of the upload waits behind it, and the stop drops
// it.
TEST_F(SdoStopTest, TheAbortOfAnUploadInSegmentsIsNotLostBeforeAStop) {
  slave_.set_bytes(kName, Bytes(250, 1));
  slave_.delay_answers(5ms);
  const auto reading = read(kName, DataType::u64);
  loop_.advance(17ms);
  ASSERT_FALSE(reading.done());
  slave_.forget_heard();
  const auto stopping = stop();
  loop_.advance(1ms);
  // The echo of a request to node 6 is late, as on a busy bus.
  closed_ = true;
  const Ticket other =
      bus_.send(TransmitClass::sdo, make_frame(0x606, Bytes{0x40, 0, 0x10, 0, 0, 0, 0, 0}), Clock::now() + 1s);
  loop_.advance(6ms);
  closed_ = false;
  loop_.advance(40ms);
  ASSERT_GT(stops_heard(), 0);
  bool aborted = false;
  for (const Frame& frame : slave_.heard_on(0x605)) {
    if (frame.data[0] == 0x2B) {
      break;
    }
    aborted = aborted || frame.data[0] == 0x80;
  }
  EXPECT_TRUE(aborted) << "a server that waits for a segment refuses the stop, naming the object of the upload";
}

// It is over, but the coroutine has not been resumed.
TEST_F(SdoStopTest, AStopIsNotSentAgainOnceItIsClosed) {
  slave_.mute(kCommand);
  const auto older = command(kCommand, kRun, 50ms);
  loop_.advance(60ms);
  ASSERT_TRUE(older.done());
  const auto stopping = stop();
  loop_.advance(5ms);
  slave_.forget_heard();
  // Answer and end in the same turn of the loop.
  const auto subscription = bus_.subscribe(kSdoAnswerBase + kSdoNode, [this](const Received&) { client_->close(); });
  confirm(kCommand);
  loop_.advance(20ms);
  EXPECT_EQ(stops_heard(), 0) << "close() sends nothing";
  EXPECT_TRUE(stopping.done());
  loop_.advance(1s);
}

}  // namespace
}  // namespace canopen
