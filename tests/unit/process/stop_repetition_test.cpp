// What a supervised RPDO is repeated with once a stop came.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/process/stop_first_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

class StopRepetitionTest : public StopFirstTest {
 protected:
  std::vector<FieldWrite> whole(Raw control, double frequency = 10.0) {
    return {field("control_command", control), field("frequency_command", frequency), field("torque_command", 0.0)};
  }
};

// The stop left by RPDO and is confirmed as such; then the older run by SDO is answered, and its word is repeated.
TEST_F(StopRepetitionTest, ARunAnsweredBehindTheRpdoOfAStopIsNotRepeated) {
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
    EXPECT_EQ(rpdo[0], kStop) << log << "; stop ok after ms "
                              << std::chrono::duration_cast<std::chrono::milliseconds>(stop_at).count();
  }
  finish(run_command, 900ms);
}

// Only the answer to the run was late, and the stop by SDO behind it gets none: the motor that the RPDO stopped is
// started by the repetition.
TEST_F(StopRepetitionTest, NoRunIsRepeatedWhileTheStopBehindItWaitsForItsAnswer) {
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
TEST_F(StopRepetitionTest, ARunThatIsNeverAnsweredDoesNotEndTheRepetitionOfANewerStop) {
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

}  // namespace
}  // namespace process
