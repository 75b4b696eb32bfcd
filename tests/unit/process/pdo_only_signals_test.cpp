// Signals that the drive takes in their RPDO alone: never tried by SDO, but for a stop that has no other way.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/process/stop_first_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class PdoOnlySignalsTest : public StopFirstTest {
 protected:
  PdoOnlySignalsTest() {
    for (const auto* const name : {"control_command", "frequency_command", "torque_command"}) {
      model_.signals[signal(name)].pdo_only = true;
    }
  }
  static std::vector<Bytes> stop_at(std::uint8_t low_byte, std::uint8_t high_byte) {
    return {{low(kStop), 0, low_byte, high_byte, 0, 0}};
  }
};

/// A stop that is completed by reading: the drive answers in the end, or not.
class OlderStopTest : public PdoOnlySignalsTest, public testing::WithParamInterface<bool> {};

TEST_F(PdoOnlySignalsTest, ASingleWriteIsIncompleteAtOnceAndNamesWhatIsMissing) {
  bring_online();
  for (const FieldWrite& single : {field("frequency_command", 20.0), field("control_command", Raw{1})}) {
    const Outcome outcome = write_now({single});
    expect_refused(outcome, ErrorKind::incomplete);
    EXPECT_NE(outcome.error().detail.find("write control_command, frequency_command and torque_command together"),
              std::string::npos)
        << outcome.error().detail;
    EXPECT_EQ(outcome.error().object, model_.signals[single.signal].object);
  }
  expect_silence();
}

TEST_F(PdoOnlySignalsTest, NothingBesideItIsSentEither) {
  bring_online();
  const Outcome outcome = write_now({field("upper_limit", Raw{4000}), field("control_command", Raw{1})});
  expect_refused(outcome, ErrorKind::incomplete);
  EXPECT_EQ(outcome.written, 0U);
  expect_silence();
}

TEST_F(PdoOnlySignalsTest, AllTogetherGoByRpdoAndThenASingleOneToo) {
  bring_online();
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  show(test::kRunningBit);
  expect_setpoint_rides_on_rpdo();
}

TEST_F(PdoOnlySignalsTest, ARawWriteOfItsObjectIsIncompleteToo) {
  bring_online();
  expect_refused(sdo_write_now({test::kFrequency, DataType::u16, 2000}), ErrorKind::incomplete);
  expect_silence();
}

TEST_F(PdoOnlySignalsTest, AStopIsCompletedByReading) {
  bring_online();
  slave_.set(test::kFrequency, DataType::u16, 3000);
  show(test::kRunningBit);
  const Sent stop = stop_by(Writer::Way::mqtt);
  EXPECT_TRUE(finish(stop, 100ms).has_value());
  EXPECT_EQ(rpdos(), stop_at(0xB8, 0x0B));
  EXPECT_TRUE(sdo_writes().empty()) << "not tried by SDO";
}

TEST_F(PdoOnlySignalsTest, AStopThatCannotBeCompletedIsTriedBySdoAtLast) {
  bring_online();
  slave_.remove(test::kFrequency);
  show(test::kRunningBit);
  EXPECT_TRUE(finish(stop_by(Writer::Way::mqtt), 100ms).has_value()) << "the profile was wrong";
  EXPECT_EQ(slave_.value(test::kControl), kStop);

  slave_.refuse_write(test::kControl, 0x06010002);
  const Outcome outcome = finish(stop_by(Writer::Way::mqtt), 100ms);
  expect_refused(outcome, ErrorKind::incomplete);
  EXPECT_NE(outcome.error().detail.find("together"), std::string::npos) << outcome.error().detail;
  EXPECT_TRUE(rpdos().empty());
}

TEST_F(PdoOnlySignalsTest, AStopBesideAnOlderOneIsNotWrittenBySdoBehindIt) {
  bring_online();
  ASSERT_TRUE(write_all(1, 30.0).has_value());
  show(test::kRunningBit);
  slave_.forget_heard();
  const Sent older = stop_by(Writer::Way::modbus);
  const Sent newer = stop_by(Writer::Way::mqtt);
  EXPECT_TRUE(finish(older, 100ms).has_value());
  EXPECT_TRUE(finish(newer, 100ms).has_value());
  EXPECT_TRUE(sdo_writes().empty());
}

// Disable voltage, say, waits for what completes it; then a quick stop with all values leaves at once, and is
// confirmed.
TEST_P(OlderStopTest, DoesNotLeaveBehindANewerOne) {
  bring_online();
  show(test::kRunningBit);
  slave_.mute(test::kFrequency);
  slave_.forget_heard();
  const Sent older = stop_by(Writer::Way::modbus);
  run(20ms);
  ASSERT_TRUE(rpdos().empty()) << "it reads";
  const Sent newer =
      write_by(origin(Writer::Way::mqtt),
               {field("control_command", Raw{kStop}), field("frequency_command", 12.0), field("torque_command", 0.0)});
  run(20ms);
  ASSERT_EQ(rpdos().size(), 1U);
  if (GetParam()) {
    slave_.unmute(test::kFrequency);
  }
  run(2s);
  ASSERT_TRUE(newer.done() && newer.get().has_value());
  ASSERT_TRUE(older.done());
  ASSERT_TRUE(older.get().has_error());
  EXPECT_EQ(older.get().error().kind, ErrorKind::superseded) << canopen::to_string(older.get().error());
  EXPECT_EQ(rpdos().size(), 1U);
  EXPECT_TRUE(sdo_writes().empty());
}

INSTANTIATE_TEST_SUITE_P(ItsReading, OlderStopTest, testing::Values(true, false),
                         [](const auto& answered) { return answered.param ? "IsAnswered" : "IsNotAnswered"; });

TEST_F(PdoOnlySignalsTest, AStopOfADriveThatIsLostGoesBySdo) {
  bring_online();
  slave_.set_state(0x7F);
  run(50ms);
  slave_.forget_heard();
  const Sent stop = stop_by(Writer::Way::mqtt);
  run(1s);
  ASSERT_TRUE(stop.done());
  EXPECT_EQ(sdo_writes(), Objects{test::kControl});
  EXPECT_TRUE(rpdos().empty());
}

}  // namespace
}  // namespace process
