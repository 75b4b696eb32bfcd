// Answers to requests that timed out or were interrupted: none of them passes for the answer to a later request.

#include <string>
#include <vector>

#include "tests/unit/canopen/node_bench.h"
#include "tests/unit/canopen/sdo_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr ObjectAddress kDeviceType{0x1000, 0};
constexpr ObjectAddress kHeartbeat{0x1017, 0};

class SdoLateAnswersTest : public SdoBench {
 protected:
  /// A read that is on its way when the drive reboots, and whose answer comes 40 ms later.
  void interrupt_a_read(ObjectAddress object) {
    slave_.delay_answers(50ms);
    const auto reading = read(object, DataType::u16);
    loop_.advance(10ms);
    client_->interrupt();
    loop_.advance(1ms);
    ASSERT_TRUE(reading.done());
    EXPECT_EQ(reading.get().error().kind, ErrorKind::offline);
  }
  /// A read that goes unanswered, tried once.
  void time_out(ObjectAddress object) {
    const auto probing = support::spawn(loop_.executor(), client_->probe(object, DataType::u16));
    loop_.advance(501ms);
    ASSERT_TRUE(probing.done());
    ASSERT_TRUE(probing.get().has_error());
    EXPECT_EQ(probing.get().error().kind, ErrorKind::timeout);
  }
};

TEST_F(SdoLateAnswersTest, ForeignAndLateAnswersAreDropped) {
  // The answer to another client's request, a segment out of the blue, then ours.
  answer_with({{0x4B, 0x31, 0x20, 0x03, 9, 9, 0, 0},
               {0x4B, 0x30, 0x20, 0x04, 9, 9, 0, 0},
               {0x80, 0x30, 0x20, 0x04, 0, 0, 2, 6},
               {0x00, 1, 2, 3, 4, 5, 6, 7},
               {},
               {0x4B, 0x30, 0x20, 0x03, 7, 0, 0, 0}});
  EXPECT_EQ(read_now(kStatus, DataType::u16).value(), 7U);
}

TEST_F(SdoLateAnswersTest, LateAnswerToATimedOutRequestIsDropped) {
  use({.retries = 0});
  slave_.set(kStatus, DataType::u16, 1);
  slave_.set(kCommand, DataType::u16, 2);
  slave_.delay_answers(600ms);
  const auto first = read(kStatus, DataType::u16);
  loop_.advance(550ms);
  ASSERT_TRUE(first.done());
  EXPECT_EQ(first.get().error().kind, ErrorKind::timeout);
  const auto second = read(kCommand, DataType::u16);
  loop_.advance(100ms);  // The late answer arrives at 600 ms.
  EXPECT_FALSE(second.done());
  slave_.send(0x585, {0x4B, 0x30, 0x20, 0x02, 2, 0, 0, 0});
  loop_.advance(1ms);
  ASSERT_TRUE(second.done());
  EXPECT_EQ(second.get().value(), 2U);
}

TEST_F(SdoLateAnswersTest, LateConfirmationNeverConfirmsTheNextCommand) {
  slave_.set(kStatus, DataType::u16, 1);
  slave_.set(kCommand, DataType::u16, 0);
  static_cast<void>(read_now(kStatus, DataType::u16));  // An object known to be readable.
  slave_.delay_answers(450ms);
  const auto first = command(kCommand, 5, 300ms);
  loop_.advance(301ms);
  ASSERT_TRUE(first.done());
  EXPECT_TRUE(first.get().error().outcome_unknown);
  slave_.refuse_write(kCommand, 0x08000022);
  const auto second = command(kCommand, 6, 2s);
  loop_.advance(200ms);  // Here the first one's confirmation arrives.
  EXPECT_FALSE(second.done());
  loop_.advance(1s);
  ASSERT_TRUE(second.done());
  EXPECT_EQ(second.get().error().kind, ErrorKind::refused);
  EXPECT_EQ(slave_.value(kCommand), 5U);
}

TEST_F(SdoLateAnswersTest, ACommandLeavesAlsoWhereTheDriveStaysSilent) {
  slave_.set(kStatus, DataType::u16, 1);
  slave_.set(kCommand, DataType::u16, 0);
  static_cast<void>(read_now(kStatus, DataType::u16));
  slave_.delay_answers(1100ms);  // What it is sent it does, but says so late.
  const auto start = command(kCommand, 1, 500ms);
  loop_.advance(550ms);
  ASSERT_TRUE(start.done());
  EXPECT_TRUE(start.get().error().outcome_unknown);
  slave_.delay_answers(2s);
  const auto stop = command(kCommand, 5);
  loop_.advance(420ms);
  const auto sent = slave_.heard().back().bytes();
  EXPECT_EQ(Bytes(sent.begin(), sent.end()), (Bytes{0x2B, 0x30, 0x20, 0x02, 5, 0, 0, 0})) << "the stop is on the bus";
  loop_.advance(600ms);
  ASSERT_TRUE(stop.done());
  EXPECT_EQ(stop.get().error().kind, ErrorKind::timeout);
  EXPECT_TRUE(stop.get().error().outcome_unknown);
  EXPECT_NE(stop.get().error().detail.find("earlier request"), std::string::npos) << stop.get().error().detail;
  // The answer to the first one ended the second, whose own answer comes when a third is on its way.
  loop_.advance(990ms);
  const auto third = command(kCommand, 6);
  loop_.advance(850ms);
  ASSERT_TRUE(third.done());
  ASSERT_TRUE(third.get().has_error()) << "confirmed by the answer to another";
  EXPECT_TRUE(third.get().error().outcome_unknown);
}

TEST_F(SdoLateAnswersTest, WithoutProofNoAnswerConfirmsOrRefusesACommand) {
  for (const bool confirmed : {true, false}) {
    slave_.script({});
    slave_.mute_sdo(true);
    use({});
    const auto first = command(kCommand, 1, 500ms);
    loop_.advance(550ms);
    ASSERT_TRUE(first.done());
    slave_.mute_sdo(false);
    answer_with({confirmed ? Bytes{0x60, 0x30, 0x20, 0x02, 0, 0, 0, 0} : Bytes{0x80, 0x30, 0x20, 0x02, 0, 0, 2, 6}});
    const auto second = command(kCommand, 5);
    loop_.advance(450ms);
    ASSERT_TRUE(second.done());
    ASSERT_TRUE(second.get().has_error());
    EXPECT_EQ(second.get().error().kind, ErrorKind::timeout);
    EXPECT_TRUE(second.get().error().outcome_unknown);
    EXPECT_NE(second.get().error().detail.find("earlier request"), std::string::npos) << second.get().error().detail;
  }
}

TEST_F(SdoLateAnswersTest, TheAnswerToAnInterruptedReadConfirmsNoCommand) {
  use({.accept_upload_style_write_answer = true});
  slave_.set(kCommand, DataType::u16, 7);
  slave_.refuse_write(kCommand, 0x08000022);
  interrupt_a_read(kCommand);
  const auto writing = command(kCommand, 6);
  loop_.advance(45ms);  // Here the answer to the read arrives, which looks like a confirmation.
  EXPECT_FALSE(writing.done());
  loop_.advance(110ms);
  ASSERT_TRUE(writing.done());
  EXPECT_EQ(writing.get().error().abort, 0x08000022U) << "its own answer";
  EXPECT_FALSE(writing.get().error().outcome_unknown);
}

TEST_F(SdoLateAnswersTest, TheAnswerToAnInterruptedReadIsNoProtocolErrorOfAWrite) {
  slave_.set(kHeartbeat, DataType::u16, 100);
  interrupt_a_read(kHeartbeat);
  const auto writing = write(kHeartbeat, DataType::u16, 500);
  loop_.advance(1s);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
  EXPECT_EQ(slave_.reads().back(), kDeviceType) << "0x1017 itself would prove nothing";
  EXPECT_EQ(slave_.value(kHeartbeat), 500U);
}

TEST_F(SdoLateAnswersTest, TheConfirmationOfAnInterruptedCommandConfirmsNoOther) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.delay_answers(50ms);
  const auto first = command(kCommand, 5);
  loop_.advance(10ms);
  client_->interrupt();
  slave_.refuse_write(kCommand, 0x08000022);
  const auto second = command(kCommand, 6);
  loop_.advance(200ms);
  ASSERT_TRUE(first.done() && second.done());
  EXPECT_TRUE(first.get().error().outcome_unknown);
  EXPECT_EQ(second.get().error().kind, ErrorKind::refused);
  EXPECT_EQ(slave_.value(kCommand), 5U);
}

TEST_F(SdoLateAnswersTest, AnInterruptedRequestThatNeverLeftLeavesNoDoubt) {
  slave_.set(kCommand, DataType::u16, 0);
  closed_ = true;
  const auto reading = read(kCommand, DataType::u16);
  loop_.advance(10ms);
  client_->interrupt();
  closed_ = false;
  loop_.settle();
  EXPECT_TRUE(command_now(kCommand, 5).has_value());
  EXPECT_TRUE(slave_.reads().empty());
}

TEST_F(SdoLateAnswersTest, ATransferOfAnotherObjectIsItsOwnProof) {
  slave_.set(kStatus, DataType::u16, 1);
  slave_.set(kCommand, DataType::u16, 0);
  slave_.mute_sdo(true);
  time_out(kCommand);
  slave_.mute_sdo(false);
  EXPECT_TRUE(read_now(kStatus, DataType::u16).has_value());
  EXPECT_TRUE(command_now(kCommand, 5).has_value());
  EXPECT_EQ(slave_.reads(), (std::vector<ObjectAddress>{kCommand, kStatus}));
}

TEST_F(SdoLateAnswersTest, HoweverLongAgoItWasARequestIsNotForgotten) {
  use({.accept_upload_style_write_answer = true});
  slave_.set(kCommand, DataType::u16, 0);
  slave_.mute_sdo(true);
  time_out(kCommand);
  slave_.mute_sdo(false);
  loop_.advance(30s);
  slave_.delay_answers(10ms);
  const auto writing = command(kCommand, 5);
  loop_.advance(5ms);
  slave_.send(0x585, {0x4B, 0x30, 0x20, 0x02, 7, 0, 0, 0});
  loop_.advance(30ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value());
  EXPECT_EQ(slave_.value(kCommand), 5U);
  EXPECT_TRUE(remarks_.empty()) << "the late answer with another value was taken for the confirmation";
}

TEST_F(SdoLateAnswersTest, ALateProofProvesNothing) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.delay_answers(1100ms);
  const auto start = command(kCommand, 1, 500ms);  // Its answer comes at 1100 ms.
  loop_.advance(550ms);
  slave_.delay_answers(2s);
  const auto stop = command(kCommand, 5);  // The proof at 2550 ms, the stop's own answer at 2950 ms.
  loop_.advance(1950ms);
  ASSERT_TRUE(start.done() && stop.done());
  EXPECT_TRUE(stop.get().error().outcome_unknown);
  const auto third = command(kCommand, 6);
  loop_.advance(480ms);
  ASSERT_TRUE(third.done());
  ASSERT_TRUE(third.get().has_error()) << "confirmed by the answer to the stop";
  EXPECT_TRUE(third.get().error().outcome_unknown);
}

TEST_F(SdoLateAnswersTest, ASilentNodeCostsOneTransferAProbe) {
  slave_.mute_sdo(true);
  for (std::size_t probes = 1; probes <= 6; ++probes) {
    time_out(kHeartbeat);
    EXPECT_EQ(slave_.heard_on(0x605).size(), probes);
    loop_.advance(3s);
  }
  slave_.mute_sdo(false);
  EXPECT_EQ(read_now(kHeartbeat, DataType::u16).value(), 100U);
  EXPECT_LE(slave_.heard_on(0x605).size(), 8U);
}

TEST_F(SdoLateAnswersTest, AReadWaitsUntilAProofIsOneWhereAllWereInterrupted) {
  slave_.set(kHeartbeat, DataType::u16, 100);
  slave_.set(kCommand, DataType::u16, 0);
  for (int boot_ups = 0; boot_ups < 4; ++boot_ups) {
    interrupt_a_read(kHeartbeat);
  }
  const auto reading = read(kHeartbeat, DataType::u16);
  loop_.advance(1s);
  EXPECT_FALSE(reading.done());
  const auto stop = command(kCommand, 5);
  loop_.advance(60ms);
  EXPECT_TRUE(stop.done()) << "commands need not wait for that";
  loop_.advance(1200ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().value(), 100U);
}

TEST_F(SdoLateAnswersTest, AnAbortWithoutObjectEndsWhatIsUnderWay) {
  answer_with({{0x80, 0, 0, 0, 0, 0, 2, 6}});
  const Result<Raw> reading = read_now(kStatus, DataType::u16);
  ASSERT_TRUE(reading.has_error());
  EXPECT_EQ(reading.error().kind, ErrorKind::refused);
  EXPECT_EQ(reading.error().object, kStatus);
  EXPECT_EQ(reading.error().abort, 0x06020000U);
  const Result<void> writing = command_now(kCommand, 5);
  ASSERT_TRUE(writing.has_error());
  EXPECT_EQ(writing.error().kind, ErrorKind::refused);
  EXPECT_FALSE(writing.error().outcome_unknown);
}

TEST_F(SdoLateAnswersTest, AnAbortWithoutObjectThatMayBeLateEndsNothing) {
  slave_.set(kStatus, DataType::u16, 3);
  slave_.mute_sdo(true);
  time_out(kCommand);
  slave_.mute_sdo(false);
  slave_.delay_answers(20ms);
  const auto reading = read(kStatus, DataType::u16);
  loop_.advance(10ms);
  slave_.send(0x585, {0x80, 0, 0, 0, 0, 0, 2, 6});
  loop_.advance(20ms);
  ASSERT_TRUE(reading.done());
  EXPECT_EQ(reading.get().value(), 3U);
}

/// A boot that is interrupted by the drive's boot-up while an answer is on its way.
class LateAnswerAtBootTest : public NodeBench {
 protected:
  void boot_again_after(Duration time) {
    slave_.boot_up();
    loop_.advance(time);
  }
  void expect_no_letter() const {
    for (const NodeStatus& told : events_.statuses) {
      EXPECT_FALSE(is_letter(told.boot_result)) << told.boot_text;
    }
  }
};

TEST_F(LateAnswerAtBootTest, ItIsIgnored) {
  install(bench_settings());
  slave_.set(kHeartbeat, DataType::u16, 0);
  slave_.delay_answers(20ms);
  start(bench_settings());
  boot_again_after(15ms);  // 0x1017 is read and will be written.
  ASSERT_EQ(slave_.reads(), std::vector<ObjectAddress>{kHeartbeat});
  slave_.boot_up();
  ASSERT_TRUE(wait_online());
  EXPECT_EQ(slave_.value(kHeartbeat), 500U);
  expect_no_letter();
}

TEST_F(LateAnswerAtBootTest, SeveralBootUpsAtOnceAreNoAlarmEither) {
  install(bench_settings());
  slave_.set(kHeartbeat, DataType::u16, 0);
  slave_.delay_answers(20ms);
  start(bench_settings());
  for (int boot_ups = 0; boot_ups < 5; ++boot_ups) {
    boot_again_after(11ms);
  }
  ASSERT_TRUE(wait_online(4s));
  EXPECT_EQ(slave_.value(kHeartbeat), 500U);
  expect_no_letter();
}

}  // namespace
}  // namespace canopen
