// A stop that goes by SDO waits no longer than 100 ms for an older one.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/unit/process/stop_first_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class StopsInARowTest : public StopFirstTest {
 protected:
  static constexpr Raw kOtherStop = 6;
  static constexpr Raw kThirdStop = 8;
  static constexpr Duration kPatience = 105ms;  ///< With what the bus and the bench take.

  /// The motor runs, and of RPDO1 nothing was commanded: every stop goes by SDO.
  void start_motor() {
    for (const Raw other : {kOtherStop, kThirdStop}) {
      model_.node.motor.stops.push_back({.equals = other});
    }
    bring_online();
    show(test::kRunningBit);
  }
  Sent stop_with(Raw word) { return write_by(origin(Writer::Way::mqtt), {field("control_command", word)}); }
  void confirm_control() {
    slave_.send(0x585, {0x60, 0x30, 0x20, 0x02, 0, 0, 0, 0});
    run(1ms);
  }
  [[nodiscard]] long times_written(Raw word) const {
    const auto heard = slave_.heard_on(0x605);
    return std::count(heard.begin(), heard.end(),
                      canopen::make_frame(0x605, Bytes{0x2B, 0x30, 0x20, 0x02, low(word), 0, 0, 0}));
  }
  void expect_written_within(Raw word, Duration limit) {
    Duration passed{};
    for (; passed <= limit && times_written(word) == 0; passed += 1ms) {
      run(1ms);
    }
    EXPECT_LE(passed, limit) << "stop " << word;
  }
  static void expect_not_confirmed(const Sent& stop) {
    ASSERT_TRUE(stop.done());
    ASSERT_TRUE(stop.get().has_error());
    EXPECT_TRUE(stop.get().error().outcome_unknown) << canopen::to_string(stop.get().error());
  }
};

TEST_F(StopsInARowTest, AnOlderOneThatIsSentAgainIsNotWaitedForAnew) {
  start_motor();
  slave_.mute(test::kControl);
  const Sent run_command = write({field("control_command", Raw{1})});
  run(10ms);
  const Sent older = stop_with(kStop);
  run(110ms);
  ASSERT_TRUE(run_command.done());
  ASSERT_EQ(times_written(kStop), 1);
  const Sent newer = stop_with(kOtherStop);
  run(20ms);
  confirm_control();
  ASSERT_EQ(times_written(kStop), 2) << "that was the answer to the run command";
  expect_written_within(kOtherStop, kPatience - 21ms);
  expect_not_confirmed(older);
  run(900ms);
  EXPECT_TRUE(newer.done());
}

TEST_F(StopsInARowTest, NorForEachOfTheReadsThatCompleteAnOlderOne) {
  start_motor();
  slave_.refuse_write(test::kControl, 0x06010002);
  slave_.mute(test::kFrequency);
  slave_.mute(test::kTorque);
  const Sent older = stop_with(kStop);
  run(10ms);
  ASSERT_EQ(slave_.reads().back(), test::kFrequency);
  const Sent newer = stop_with(kOtherStop);
  run(80ms);
  slave_.send(0x585, {0x4B, 0x30, 0x20, 0x01, 0, 0, 0, 0});
  run(2ms);
  ASSERT_EQ(slave_.reads().back(), test::kTorque);
  expect_written_within(kOtherStop, kPatience - 82ms);
  EXPECT_TRUE(older.done());
  run(900ms);
  EXPECT_TRUE(newer.done());
}

TEST_F(StopsInARowTest, NorForOneThatHadToWaitForASlowWrite) {
  answer_slow_object(std::nullopt);
  start_motor();
  slave_.mute(test::kControl);
  const Sent slow = write_slow_object();
  run(10ms);
  const Sent older = stop_with(kStop);
  run(10ms);
  const Sent newer = stop_with(kOtherStop);
  expect_written_within(kStop, kPatience - 10ms);
  expect_written_within(kOtherStop, 20ms);
  expect_not_confirmed(older);
  run(900ms);
  EXPECT_TRUE(slow.done() && newer.done());
}

TEST_F(StopsInARowTest, NorForOneWhoseTurnComesWhileANewerOneWaits) {
  start_motor();
  slave_.mute(test::kControl);
  const Sent first = stop_with(kStop);
  run(10ms);
  const Sent second = stop_with(kOtherStop);
  const Sent third = stop_with(kThirdStop);
  expect_written_within(kOtherStop, kPatience);
  EXPECT_EQ(times_written(kThirdStop), 0);
  run(50ms);
  confirm_control();
  ASSERT_EQ(times_written(kOtherStop), 2) << "that was the answer to the first";
  expect_written_within(kThirdStop, kPatience - 51ms);
  expect_not_confirmed(first);
  expect_not_confirmed(second);
  run(900ms);
  EXPECT_TRUE(third.done());
}

TEST_F(StopsInARowTest, TheNewestHasAllItsTime) {
  start_motor();
  slave_.mute(test::kControl);
  const Sent older = stop_with(kStop);
  run(10ms);
  const Sent newer = stop_with(kOtherStop);
  run(700ms);
  ASSERT_TRUE(older.done());
  EXPECT_FALSE(newer.done());
  confirm_control();
  confirm_control();
  ASSERT_TRUE(newer.done());
  EXPECT_TRUE(newer.get().has_value()) << canopen::to_string(newer.get().error());
}

// Two writers hold a stop, each waits for its answer: a drive that takes it by PDO only never gets one.
TEST_F(StopsInARowTest, StopsThatKeepComingStopADriveThatTakesThemByPdoOnly) {
  bring_online();
  for (const canopen::ObjectAddress object : {test::kControl, test::kFrequency, test::kTorque}) {
    slave_.refuse_write(object, 0x06010002);
  }
  show(test::kRunningBit);
  slave_.delay_answers(10ms);
  Sent first = stop_by(Writer::Way::modbus);
  run(15ms);
  Sent second = stop_by(Writer::Way::mqtt);
  int given = 2;
  Duration passed{};
  for (; passed < 5s && rpdos().empty(); passed += 1ms) {
    run(1ms);
    if (first.done()) {
      first = stop_by(Writer::Way::modbus);
      ++given;
    }
    if (second.done()) {
      second = stop_by(Writer::Way::mqtt);
      ++given;
    }
  }
  EXPECT_FALSE(rpdos().empty()) << given << " stops, and none on the bus by RPDO in 5 s";
  run(2s);
}

// Equal: the older one is not answered; the newer one is to leave 100 ms later.
TEST_F(StopsInARowTest, AnEqualStopIsOnTheWireWithin150Milliseconds) {
  bring_online();
  show(test::kRunningBit);
  slave_.mute(test::kControl);
  const Sent older = stop_by(Writer::Way::modbus);
  run(200ms);
  slave_.forget_heard();
  const Sent newer = stop_by(Writer::Way::mqtt);
  EXPECT_LE(until_on_wire(900ms), 150ms);
  finish(older, 900ms);
  finish(newer, 1900ms);
}

TEST_F(StopsInARowTest, TwoEqualOnesAreConfirmedByADriveThatAnswersLate) {
  start_motor();
  for (const Duration answer : {110ms, 150ms, 200ms}) {
    slave_.delay_answers(answer);
    const Sent older = stop_by(Writer::Way::modbus);
    run(5ms);
    const Sent newer = stop_by(Writer::Way::mqtt);
    EXPECT_TRUE(finish(older, 1s).has_value()) << "the answer to the newer one proves it, too";
    EXPECT_TRUE(finish(newer, 1s).has_value());
    slave_.delay_answers(0ms);
    run(1s);
  }
}

TEST_F(StopsInARowTest, NorForAnEqualOneWhoseTurnComesWhileItWaits) {
  start_motor();
  slave_.mute(test::kControl);
  const Sent first = stop_with(kOtherStop);
  run(10ms);
  const Sent second =
      write_by(origin(Writer::Way::mqtt), {field("control_command", kStop), field("frequency_command", 10.0)});
  const Sent third = stop_by(Writer::Way::modbus);
  expect_written_within(kStop, kPatience);
  ASSERT_EQ(times_written(kStop), 1);
  Duration passed{};
  for (; passed <= kPatience && times_written(kStop) == 1; passed += 1ms) {
    run(1ms);
  }
  EXPECT_LE(passed, kPatience) << "the third one";
  run(2s);
  EXPECT_TRUE(first.done() && second.done() && third.done());
}

TEST_F(StopsInARowTest, AnEqualOneThatIsNotConfirmedConfirmsNone) {
  start_motor();
  slave_.mute(test::kControl);
  const Sent older = stop_by(Writer::Way::modbus);
  run(5ms);
  const Sent newer = stop_by(Writer::Way::mqtt);
  run(2s);
  expect_not_confirmed(older);
  expect_not_confirmed(newer);
}

}  // namespace
}  // namespace process
