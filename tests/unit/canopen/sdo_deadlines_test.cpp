// The deadline of a command by SDO: what is not begun by then never leaves, what is begun is awaited until then.

#include <vector>

#include "tests/unit/canopen/sdo_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SdoDeadlinesTest : public SdoBench {};

TEST_F(SdoDeadlinesTest, CommandIsSentOnceAndItsOutcomeUnknown) {
  slave_.mute_sdo(true);
  const auto writing = command(kCommand, 5);
  loop_.advance(799ms);
  EXPECT_FALSE(writing.done()) << "whatever the time of an answer is";
  loop_.advance(2ms);
  ASSERT_TRUE(writing.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::timeout);
  EXPECT_TRUE(writing.get().error().outcome_unknown);
  EXPECT_EQ(writing.get().error().detail, "no answer in 800 ms");
  loop_.advance(3s);
  EXPECT_EQ(slave_.heard_on(0x605).size(), 1U);
}

TEST_F(SdoDeadlinesTest, ADriveThatWritesItsFlashFirstConfirmsInTime) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.delay_answers(700ms);
  const auto writing = command(kCommand, 5);
  loop_.advance(705ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
}

TEST_F(SdoDeadlinesTest, ACommandIsNotBegunWhenTooLittleTimeIsLeftForTheAnswer) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.mute(kStatus);
  struct Case {
    Duration writes_take;
    Duration deadline;  ///< Its turn comes after 500 ms.
    bool begun;
  };
  for (const Case& each : {Case{1ms, 549ms, true}, Case{100ms, 590ms, false}, Case{100ms, 610ms, true},
                           Case{700ms, 1010ms, true}, Case{700ms, 990ms, false}}) {
    use({.retries = 0});
    slave_.delay_answers(each.writes_take);
    const auto known = command(kCommand, 1, 2s);
    loop_.advance(800ms);
    ASSERT_TRUE(known.done() && known.get().has_value());
    slave_.delay_answers({});
    const auto reading = read(kStatus, DataType::u16);
    loop_.advance(1ms);
    slave_.forget_heard();
    const auto writing = command(kCommand, 5, each.deadline);
    loop_.advance(520ms);
    ASSERT_TRUE(writing.done());
    EXPECT_EQ(writing.get().has_value(), each.begun);
    EXPECT_EQ(slave_.writes().size(), each.begun ? 1U : 0U);
    if (!each.begun) {
      EXPECT_EQ(writing.get().error().kind, ErrorKind::timeout);
      EXPECT_TRUE(writing.get().error().not_sent);
      EXPECT_NE(writing.get().error().detail.find("too little time"), std::string::npos);
    }
  }
}

TEST_F(SdoDeadlinesTest, BeforeAWriteWasConfirmedFiftyMillisecondsMustBeLeft) {
  slave_.set(kCommand, DataType::u16, 0);
  slave_.mute(kStatus);
  for (const bool begun : {false, true}) {
    use({.retries = 0});
    const auto reading = read(kStatus, DataType::u16);
    loop_.advance(1ms);
    const auto writing = command(kCommand, 5, begun ? 560ms : 540ms);
    loop_.advance(520ms);
    ASSERT_TRUE(writing.done());
    EXPECT_EQ(writing.get().has_value(), begun);
  }
}

TEST_F(SdoDeadlinesTest, CommandEndsAtItsDeadline) {
  slave_.mute_sdo(true);
  const auto writing = command(kCommand, 5, 100ms);
  loop_.advance(101ms);
  ASSERT_TRUE(writing.done());
  EXPECT_TRUE(writing.get().error().outcome_unknown);
}

TEST_F(SdoDeadlinesTest, CommandThatCannotBeginIsWithdrawn) {
  slave_.mute_sdo(true);
  const auto reading = read(kStatus, DataType::u16);
  const auto writing = command(kCommand, 5, 100ms);
  loop_.advance(101ms);
  ASSERT_TRUE(writing.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::timeout);
  EXPECT_FALSE(writing.get().error().outcome_unknown);
  EXPECT_TRUE(writing.get().error().not_sent);
  loop_.advance(3s);
  EXPECT_TRUE(slave_.writes().empty());
}

TEST_F(SdoDeadlinesTest, ACommandThatCannotLeaveIsNotUnknown) {
  closed_ = true;
  const auto writing = command(kCommand, 5, 300ms);
  loop_.advance(301ms);
  ASSERT_TRUE(writing.done());
  EXPECT_EQ(writing.get().error().kind, ErrorKind::timeout);
  EXPECT_TRUE(writing.get().error().not_sent);
  EXPECT_FALSE(writing.get().error().outcome_unknown);
}

}  // namespace
}  // namespace canopen
