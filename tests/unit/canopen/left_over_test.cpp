// Nothing of a procedure that was interrupted or has ended leaves later, when the bus lets our frames go again.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using Bytes = support::ScriptedSlave::Bytes;

class LeftOverTest : public NodeCommandBench {
 protected:
  /// A boot that has to write the mapping of TPDO1, up to the moment when `done` says so.
  template <class Predicate>
  void boot_until(Predicate done) {
    install(bench_settings());
    slave_.set(kMapping, DataType::u32, kOtherMapping);
    start(bench_settings());
    slave_.delay_answers(5ms);
    slave_.boot_up();
    ASSERT_TRUE(loop_.advance_until(done, 2s));
  }
  /// The drive runs, and supervises its RPDO: it is repeated each 100 ms.
  void run_supervised() {
    NodeSettings settings = bench_settings();
    settings.rpdos[0].event_timer = std::uint16_t{300};
    bring_online(settings);
    ASSERT_TRUE(rpdo_now({control(0x0F), target(100)}).has_value());
  }
  /// The node loses its power for a moment: all is as it was delivered.
  void reboot() {
    install(bench_settings());
    slave_.set(kMapping, DataType::u32, kOtherMapping);
    slave_.forget_heard();
    slave_.boot_up();
    loop_.advance(100ms);
  }
  /// The end of the test sends nothing either.
  ~LeftOverTest() override { closed_ = false; }
};

TEST_F(LeftOverTest, ARequestThatWaitedLeavesOnceHoweverLongItWaited) {
  bring_online(bench_settings());
  closed_ = true;
  const auto reading = support::spawn(loop_.executor(), node_->read(kTarget, DataType::i16));
  loop_.advance(700ms);
  closed_ = false;
  loop_.advance(40ms);
  EXPECT_EQ(slave_.reads(), std::vector<ObjectAddress>{kTarget});
  ASSERT_TRUE(reading.done());
  EXPECT_TRUE(reading.get().has_value()) << "a busy bus is no silent drive";
}

TEST_F(LeftOverTest, NoneOfTheTriesLeavesAfterTheRead) {
  bring_online(bench_settings());
  closed_ = true;
  const auto reading = support::spawn(loop_.executor(), node_->read(kTarget, DataType::i16));
  ASSERT_TRUE(loop_.advance_until([&] { return reading.done(); }, 10s));
  EXPECT_EQ(reading.get().error().kind, ErrorKind::timeout);
  closed_ = false;
  loop_.advance(3s);
  EXPECT_TRUE(slave_.reads().empty());
}

TEST_F(LeftOverTest, AWriteOfABootDoesNotLeaveAfterTheBootUpThatInterruptedIt) {
  boot_until([&] { return slave_.writes().size() == 2; });
  closed_ = true;
  loop_.advance(20ms);
  reboot();
  ASSERT_TRUE(slave_.heard().empty());
  closed_ = false;
  ASSERT_TRUE(loop_.advance_until([&] { return !slave_.writes().empty(); }, 1s));
  EXPECT_GE(slave_.reads().size(), 5U) << "it is looked at before anything is written";
  EXPECT_EQ(slave_.writes().front(), (ObjectAddress{0x1800, 1})) << "the set-up begins at its begin";
}

TEST_F(LeftOverTest, NmtStartOfABootDoesNotLeaveAfterTheNextBootUp) {
  // From the last read on nothing of ours can leave.
  slave_.script([this](const Bytes& request) -> std::optional<std::vector<Bytes>> {
    closed_ = closed_ || request == Bytes{0x40, 0x14, 0x10, 0x00, 0, 0, 0, 0};
    return std::nullopt;
  });
  boot_until([this] { return status().configured; });
  slave_.script({});
  ASSERT_EQ(slave_.state(), 127) << "NMT start waits";
  reboot();
  closed_ = false;
  loop_.advance(1ms);
  EXPECT_TRUE(nmt_heard().empty());
  ASSERT_TRUE(loop_.advance_until([&] { return slave_.state() == 5; }, 2s));
  EXPECT_EQ(slave_.value(kMapping), 0x60440010U) << "started with its default mapping";
  const std::size_t writes = slave_.writes().size();
  loop_.advance(2s);
  EXPECT_EQ(slave_.writes().size(), writes);
}

TEST_F(LeftOverTest, ACommandedStartDoesNotReachADriveThatHasRebooted) {
  bring_online(bench_settings());
  closed_ = true;
  const auto starting = command(NmtCommand::start);
  loop_.advance(50ms);
  EXPECT_FALSE(starting.done());
  reboot();
  ASSERT_TRUE(starting.done());
  EXPECT_EQ(starting.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(starting.get().error().outcome_unknown);
  closed_ = false;
  loop_.advance(1ms);
  EXPECT_TRUE(nmt_heard().empty());
}

TEST_F(LeftOverTest, ACommandedStopReachesItAllTheSame) {
  bring_online(bench_settings());
  closed_ = true;
  const auto stopping = command(NmtCommand::stop);
  loop_.advance(50ms);
  reboot();
  EXPECT_FALSE(stopping.done());
  closed_ = false;
  loop_.advance(40ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
}

TEST_F(LeftOverTest, RpdosAndRepetitionsEndWithTheLifeTheyBelongTo) {
  run_supervised();
  slave_.forget_heard();
  closed_ = true;
  loop_.advance(150ms);  // A repetition waits.
  reboot();
  closed_ = false;
  loop_.advance(1s);
  EXPECT_TRUE(slave_.heard_on(0x205).empty());

  ASSERT_TRUE(status().online);
  closed_ = true;
  const auto sending = rpdo({control(0x0F), target(200)});
  loop_.advance(10ms);
  reboot();
  ASSERT_TRUE(sending.done());
  EXPECT_EQ(sending.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(sending.get().error().outcome_unknown);
  closed_ = false;
  loop_.advance(1s);
  EXPECT_TRUE(slave_.heard_on(0x205).empty());
}

TEST_F(LeftOverTest, ACommandIsNeverFollowedByAnOlderRepetition) {
  run_supervised();
  slave_.forget_heard();
  closed_ = true;
  loop_.advance(101ms);  // A repetition waits.
  const auto stopping = rpdo({control(0x06), target(0)});
  loop_.advance(150ms);  // Another one would be due.
  closed_ = false;
  loop_.advance(250ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
  const std::vector<Frame> heard = slave_.heard_on(0x205);
  ASSERT_GE(heard.size(), 2U);
  EXPECT_TRUE(std::all_of(heard.begin(), heard.end(), [](const Frame& frame) { return frame.data[0] == 0x06; }));
}

TEST_F(LeftOverTest, ACommandBySdoIsNotUndoneByARepetitionThatWaited) {
  run_supervised();
  closed_ = true;
  loop_.advance(101ms);  // A repetition waits.
  slave_.forget_heard();
  node_->hold_repetition(kControlWord);
  const auto stopping = write(0x06);
  loop_.advance(20ms);
  closed_ = false;
  loop_.advance(50ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
  EXPECT_TRUE(slave_.heard_on(0x205).empty());
}

TEST_F(LeftOverTest, AnAnswerToSomebodyElseConfirmsNoCommandThatHasNotLeft) {
  bring_online(bench_settings());
  slave_.forget_heard();
  closed_ = true;
  const auto stopping = write(0x06);
  loop_.advance(20ms);
  slave_.send(0x585, {0x60, 0x40, 0x60, 0, 0, 0, 0, 0});
  loop_.advance(20ms);
  EXPECT_FALSE(stopping.done());
  closed_ = false;
  loop_.advance(50ms);
  ASSERT_TRUE(stopping.done());
  EXPECT_TRUE(stopping.get().has_value());
  EXPECT_EQ(slave_.writes().size(), 1U);
}

}  // namespace
}  // namespace canopen
