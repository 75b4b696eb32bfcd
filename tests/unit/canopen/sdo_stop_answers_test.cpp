// No answer to an older request confirms or refuses a stop by SDO.

#include "tests/unit/canopen/sdo_stop_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SdoStopAnswersTest : public SdoStopBench {};

TEST_F(SdoStopAnswersTest, TheLateAnswerToAnOlderWriteConfirmsNoStop) {
  slave_.mute(kCommand);
  const auto run = command(kCommand, kRun);
  loop_.advance(10ms);
  const auto stopping = stop();
  loop_.advance(110ms);
  expect_unknown(run, ErrorKind::timeout, "a stop goes first");
  ASSERT_EQ(stops_heard(), 1);
  EXPECT_TRUE(client_->may_still_act(kCommand));
  confirm(kCommand);
  EXPECT_FALSE(stopping.done());
  EXPECT_EQ(stops_heard(), 2) << "sent again at once";
  confirm(kCommand);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
  EXPECT_TRUE(client_->may_still_act(kCommand)) << "one of the two stops";
}

TEST_F(SdoStopAnswersTest, TheAbortOfAnOlderWriteRefusesNoStop) {
  slave_.mute(kCommand);
  const auto run = command(kCommand, kRun);
  loop_.advance(10ms);
  const auto stopping = stop();
  loop_.advance(110ms);
  refuse(kCommand);
  EXPECT_FALSE(stopping.done());
  ASSERT_EQ(stops_heard(), 2);
  refuse(kCommand);
  ASSERT_TRUE(stopping.done());
  EXPECT_EQ(stopping.get().error().kind, ErrorKind::refused);
  EXPECT_FALSE(stopping.get().error().outcome_unknown);
}

TEST_F(SdoStopAnswersTest, EachOlderRequestCounts) {
  slave_.mute_sdo(true);
  for (int i = 0; i < 3; ++i) {
    const auto run = command(kCommand, kRun, 20ms);
    loop_.advance(21ms);
    ASSERT_TRUE(run.done());
  }
  ASSERT_EQ(slave_.writes().size(), 3U);
  slave_.forget_heard();
  const auto stopping = stop();
  loop_.advance(5ms);
  EXPECT_TRUE(slave_.reads().empty()) << "no proof comes first";
  for (int older = 0; older < 3; ++older) {
    confirm(kCommand);
    EXPECT_FALSE(stopping.done());
    EXPECT_EQ(stops_heard(), 2 + older);
  }
  confirm(kCommand);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
}

TEST_F(SdoStopAnswersTest, AnAnswerToAnOtherObjectEndsTheDoubt) {
  slave_.mute(kCommand);
  const auto run = command(kCommand, kRun, 20ms);
  loop_.advance(21ms);
  ASSERT_TRUE(run.done());
  EXPECT_TRUE(client_->may_still_act(kCommand));
  static_cast<void>(read_now(kStatus, DataType::u16));
  EXPECT_FALSE(client_->may_still_act(kCommand));
  const auto stopping = stop();
  loop_.advance(1ms);
  confirm(kCommand);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
}

TEST_F(SdoStopAnswersTest, AnUnansweredReadOfTheSameObjectMayAbortButNotConfirm) {
  slave_.mute(kCommand);
  const auto reading = support::spawn(loop_.executor(), client_->probe(kCommand, DataType::u16));
  loop_.advance(501ms);
  ASSERT_TRUE(reading.done());
  EXPECT_FALSE(client_->may_still_act(kCommand));
  auto stopping = stop();
  loop_.advance(1ms);
  answer(0x4B, kCommand, 0);
  refuse(kCommand);
  EXPECT_FALSE(stopping.done());
  confirm(kCommand);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
}

TEST_F(SdoStopAnswersTest, WhereReadsAndWritesAreAnsweredAlikeBothCount) {
  use({.accept_upload_style_write_answer = true});
  slave_.mute(kCommand);
  const auto reading = support::spawn(loop_.executor(), client_->probe(kCommand, DataType::u16));
  loop_.advance(501ms);
  const auto stopping = stop();
  loop_.advance(1ms);
  answer(0x4B, kCommand, 0);
  EXPECT_FALSE(stopping.done());
  EXPECT_EQ(stops_heard(), 2);
  answer(0x4B, kCommand, 0);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
}

TEST_F(SdoStopAnswersTest, WithoutAnAnswerItsOutcomeIsUnknownAtItsDeadline) {
  slave_.mute(kCommand);
  const auto stopping = stop();
  loop_.advance(799ms);
  EXPECT_FALSE(stopping.done());
  loop_.advance(2ms);
  expect_unknown(stopping, ErrorKind::timeout, "sent, not confirmed");
  EXPECT_EQ(stops_heard(), 1);
}

TEST_F(SdoStopAnswersTest, SentOnceAnAnswerInDoubtConfirmsNothing) {
  slave_.mute(kCommand);
  const auto run = command(kCommand, kRun, 20ms);
  loop_.advance(21ms);
  const auto stopping = stop(800ms, 1);
  loop_.advance(1ms);
  confirm(kCommand);
  expect_unknown(stopping, ErrorKind::timeout, "sent, not confirmed: the answer may be that to an earlier request");
  EXPECT_EQ(stops_heard(), 1);
}

}  // namespace
}  // namespace canopen
