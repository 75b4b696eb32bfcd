// Proofs of a review; each fails on what it shows.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/process/stop_first_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class Review8Test : public StopFirstTest {
 protected:
  std::vector<FieldWrite> whole(Raw control, double frequency = 10.0) {
    return {field("control_command", control), field("frequency_command", frequency), field("torque_command", 0.0)};
  }
};

// The stop left by RPDO and is confirmed as such; then the older run by SDO is answered, and its word is repeated.
TEST_F(Review8Test, ARunAnsweredBehindTheRpdoOfAStopIsNotRepeated) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(60ms);
  const Sent run_command = write({field("control_command", Raw{1})});
  run(5ms);
  slave_.forget_heard();
  const Sent stop = write_by(origin(Writer::Way::mqtt), whole(kStop));
  Duration stop_at{-1};
  for (Duration t{}; t < 400ms; t += 1ms) {
    run(1ms);
    if (stop.done() && stop_at < 0ms) {
      stop_at = t;
    }
  }
  std::string log;
  for (const canopen::Frame& frame : slave_.heard()) {
    if (frame.id == kRpdo1) {
      log += " RPDO:" + std::to_string(frame.data[0]);
    } else if (frame.id == 0x605 && frame.data[0] == 0x2B && frame.data[3] == 2) {
      log += " SDO:" + std::to_string(frame.data[4]);
    }
  }
  EXPECT_TRUE(finish(stop, 1ms).has_value());
  for (const Bytes& rpdo : rpdos()) {
    EXPECT_EQ(rpdo[0], kStop) << log << "; stop ok after ms " << std::chrono::duration_cast<std::chrono::milliseconds>(stop_at).count();
  }
  finish(run_command, 900ms);
}

// Only the answer to the run was late, and the stop by SDO behind it gets none: the motor that the RPDO stopped is
// started by the repetition.
TEST_F(Review8Test, NoRunIsRepeatedWhileTheStopBehindItWaitsForItsAnswer) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(60ms);
  const Sent run_command = write({field("control_command", Raw{1})});
  run(5ms);
  slave_.mute(test::kControl);
  slave_.forget_heard();
  const Sent stop = write_by(origin(Writer::Way::mqtt), whole(kStop));
  run(750ms);
  const auto heard = rpdos();
  EXPECT_EQ(std::count_if(heard.begin(), heard.end(), [](const Bytes& rpdo) { return rpdo[0] == 1; }), 0)
      << "of " << heard.size() << " RPDOs after the stop";
  finish(stop, 900ms);
  EXPECT_TRUE(run_command.done());
}

// The same where the run is never answered: nothing is repeated any more, and the drive trips.
TEST_F(Review8Test, ARunThatIsNeverAnsweredDoesNotEndTheRepetitionOfANewerStop) {
  model_.node.rpdos[0].event_timer = std::uint16_t{300};
  bring_online();
  show(test::kRunningBit);
  slave_.script([](const Bytes& request) -> std::optional<std::vector<Bytes>> {
    const bool is_run = request[0] == 0x2B && request[1] == 0x30 && request[3] == 2 && request[4] == 1;
    return is_run ? std::optional(std::vector<Bytes>{}) : std::nullopt;
  });
  const Sent run_command = write({field("control_command", Raw{1})});
  run(5ms);
  const Sent stop = write_by(origin(Writer::Way::mqtt), whole(kStop));
  for (Duration t{}; t < 900ms && !stop.done(); t += 1ms) {
    run(1ms);
  }
  ASSERT_TRUE(stop.done());
  EXPECT_TRUE(stop.get().has_value());
  slave_.forget_heard();
  run(1s);
  EXPECT_GE(rpdos().size(), 5U) << "it trips after 300 ms of silence";
  finish(run_command, 900ms);
}

// Two writers hold a stop, each waits for its answer: a drive that takes it by PDO only never gets one.
TEST_F(Review8Test, StopsThatKeepComingStopADriveThatTakesThemByPdoOnly) {
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
TEST_F(Review8Test, AnEqualStopIsOnTheWireWithin150Milliseconds) {
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

// A waiting set-point of the same writer is older than that beside his stop.
TEST_F(Review8Test, ASetPointBesideAStopIsNotReplacedByAnOlderOne) {
  bring_online();
  show(test::kRunningBit);
  slave_.delay_answers(20ms);
  const Sent slow = write({field("upper_limit", Raw{4000})});
  run(2ms);
  const Sent older = write({field("frequency_command", 50.0)});
  run(1ms);
  const Sent stop = write(whole(kStop, 10.0));
  EXPECT_TRUE(finish(stop, 500ms).has_value());
  run(200ms);
  ASSERT_TRUE(older.done());
  EXPECT_TRUE(older.get().has_error()) << "written whole by a later command of its writer";
  EXPECT_EQ(drive_->commanded().shown(signal("frequency_command")), 1000U);
  finish(slow, 100ms);
}

// One of two faults has gone (CiA 301: the error register is not 0), then the other one.
TEST_F(Review8Test, ARunCommandedBetweenTheEndsOfTwoFaultsIsVoidAfterTheSecond) {
  bring_online();
  run_motor();
  emcy(0x0004, 0x05);
  emcy(0x0005, 0x05);
  emcy(0x0000, 0x04);
  EXPECT_TRUE(write_all(1, 30.0).has_value());
  emcy(0x0000, 0x00);
  EXPECT_FALSE(drive_->commanded().counts(signal("control_command")));
}

}  // namespace
}  // namespace process
