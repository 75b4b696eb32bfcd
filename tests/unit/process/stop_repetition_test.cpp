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
  /// To a drive that supervises RPDO1 and answers late. What was heard until then is forgotten.
  Sent begin_run_by_sdo() {
    model_.node.rpdos[0].event_timer = std::uint16_t{300};
    bring_online();
    show(test::kRunningBit);
    slave_.delay_answers(60ms);
    Sent run_command = write({field("control_command", Raw{1})});
    run(5ms);
    slave_.forget_heard();
    return run_command;
  }
};

// A run by SDO that is under way when a stop leaves by RPDO; its answer comes behind that of the stop.
TEST_F(StopRepetitionTest, ARunAnsweredBehindTheRpdoOfAStopIsNotRepeated) {
  const Sent run_command = begin_run_by_sdo();
  const Sent stop = write_by(origin(Writer::Way::mqtt), whole(kStop));
  run(400ms);
  EXPECT_TRUE(finish(stop, 1ms).has_value());
  EXPECT_FALSE(rpdos().empty());
  for (const Bytes& rpdo : rpdos()) {
    EXPECT_EQ(rpdo[0], kStop);
  }
  finish(run_command, 900ms);
}

// The same, and the stop by SDO behind it is never answered.
TEST_F(StopRepetitionTest, NoRunIsRepeatedWhileTheStopBehindItWaitsForItsAnswer) {
  const Sent run_command = begin_run_by_sdo();
  slave_.mute(test::kControl);
  const Sent stop = write_by(origin(Writer::Way::mqtt), whole(kStop));
  run(750ms);
  EXPECT_FALSE(rpdos().empty());
  for (const Bytes& rpdo : rpdos()) {
    EXPECT_EQ(rpdo[0], kStop);
  }
  finish(stop, 900ms);
  EXPECT_TRUE(run_command.done());
}

// The same where the run is never answered: the stop goes on being repeated, or the drive would trip.
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
