// A stop that a newer one waits for has 100 ms for all that is sent and read for it.

#include "tests/unit/canopen/sdo_stop_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SdoStopLimitTest : public SdoStopBench {
 protected:
  support::Spawned<Result<void>> limited_stop() {
    return support::spawn(loop_.executor(), client_->write_stop(kCommand, DataType::u16, kHalt, Clock::now() + 800ms,
                                                                SdoClient::kStopsSent, limit_));
  }
  support::Spawned<Result<Raw>> limited_read(ObjectAddress object) {
    return support::spawn(loop_.executor(),
                          client_->read_for_stop(object, DataType::u16, Clock::now() + 800ms, limit_));
  }
  void hurry(Duration newer_within = 800ms) { client_->hurry_stop(limit_, Clock::now() + newer_within); }
  /// From now on.
  template <class Ended>
  void expect_ended_after(const Ended& stop, Duration time) {
    loop_.advance(time - 1ms);
    EXPECT_FALSE(stop.done());
    loop_.advance(3ms);
    EXPECT_TRUE(stop.done());
  }

  StopLimit limit_;
};

TEST_F(SdoStopLimitTest, OneThatIsSentAgainHasNoMoreTime) {
  slave_.mute(kCommand);
  const auto run = command(kCommand, kRun, 20ms);
  loop_.advance(21ms);
  const auto stopping = limited_stop();
  loop_.advance(10ms);
  hurry();
  loop_.advance(40ms);
  confirm(kCommand);
  ASSERT_EQ(stops_heard(), 2);
  expect_ended_after(stopping, 60ms);
  expect_unknown(stopping, ErrorKind::timeout, "sent, not confirmed");
  EXPECT_EQ(stops_heard(), 2);
}

TEST_F(SdoStopLimitTest, OneThatIsSentAgainIsStillConfirmedWithinIt) {
  slave_.mute(kCommand);
  const auto run = command(kCommand, kRun, 20ms);
  loop_.advance(21ms);
  const auto stopping = limited_stop();
  loop_.advance(10ms);
  hurry();
  confirm(kCommand);
  loop_.advance(90ms);
  ASSERT_EQ(stops_heard(), 2);
  confirm(kCommand);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
}

TEST_F(SdoStopLimitTest, OneThatWaitsForAReadUnderWayIsSentAndNotWaitedForLonger) {
  slave_.mute(kStatus);
  slave_.mute(kCommand);
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(10ms);
  const auto stopping = limited_stop();
  loop_.advance(50ms);
  hurry();
  loop_.advance(55ms);
  EXPECT_EQ(stops_heard(), 1);
  expect_ended_after(stopping, 46ms);
  expect_unknown(stopping, ErrorKind::timeout, "sent, not confirmed");
}

TEST_F(SdoStopLimitTest, OneThatBeginsWhileANewerOneWaitsHasHalfOfThatOnesTime) {
  slave_.mute(kCommand);
  hurry(60ms);
  const auto stopping = limited_stop();
  expect_ended_after(stopping, 30ms);
  expect_unknown(stopping, ErrorKind::timeout, "sent, not confirmed");
  EXPECT_EQ(stops_heard(), 1);
}

TEST_F(SdoStopLimitTest, ASecondReadOfAnObjectHasNoMoreTime) {
  slave_.mute(kSetPoint);
  const auto older = limited_read(kSetPoint);
  loop_.advance(10ms);
  client_->interrupt();
  loop_.advance(1ms);
  ASSERT_TRUE(older.done());
  slave_.forget_heard();

  const auto reading = limited_read(kSetPoint);
  loop_.advance(10ms);
  hurry();
  loop_.advance(50ms);
  answer(0x4B, kSetPoint, 0);
  ASSERT_EQ(slave_.reads().size(), 2U) << "that may have been the answer to the older one";
  expect_ended_after(reading, 50ms);
  EXPECT_EQ(reading.get().error().kind, ErrorKind::timeout);
}

TEST_F(SdoStopLimitTest, NorHasTheNextReadOfTheSameStop) {
  slave_.mute(kSetPoint);
  slave_.mute(kStatus);
  const auto first = limited_read(kSetPoint);
  loop_.advance(10ms);
  hurry();
  loop_.advance(50ms);
  answer(0x4B, kSetPoint, 0);
  ASSERT_TRUE(first.done());
  ASSERT_TRUE(first.get().has_value());
  const auto second = limited_read(kStatus);
  expect_ended_after(second, 50ms);
  EXPECT_EQ(second.get().error().kind, ErrorKind::timeout);
}

TEST_F(SdoStopLimitTest, ANewerOneIsNotLimitedByWhatTheOlderOneWas) {
  slave_.mute(kCommand);
  const auto older = limited_stop();
  loop_.advance(10ms);
  const auto newer = stop();
  hurry();
  loop_.advance(105ms);
  ASSERT_TRUE(older.done());
  hurry();
  loop_.advance(600ms);
  EXPECT_FALSE(newer.done());
  confirm(kCommand);
  confirm(kCommand);
  ASSERT_TRUE(newer.done());
  EXPECT_TRUE(newer.get().has_value());
}

}  // namespace
}  // namespace canopen
