// The RPDOs of one node on a bus: what is withdrawn, and when what is supervised is repeated.

#include "canopen/node/outputs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/asio/use_awaitable.hpp>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/transmission.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/gated_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kNode = 5;
constexpr ObjectAddress kControl{0x6040, 0};
constexpr ObjectAddress kTarget{0x6042, 0};
constexpr Duration kEventTimer = 300ms;
constexpr Duration kPeriod = 100ms;

ObjectValue control(Raw raw) {
  return {kControl, DataType::u16, raw};
}

ObjectValue target(Raw raw) {
  return {kTarget, DataType::u16, raw};
}

PdoSettings supervised() {
  return {.cob_id = 0x205, .event_timer = 300, .mapping = {{.object = kControl}, {.object = kTarget}}};
}

class OutputsTest : public testing::Test {
 protected:
  /// An RPDO on the wire, and how long after the begin of the record.
  using Heard = std::pair<Duration, std::vector<int>>;
  using Sent = support::Spawned<Result<void>>;

  OutputsTest() {
    bus_.start();
    drive_.start();
    loop_.advance(1ms);
  }
  ~OutputsTest() override {
    outputs_.cease();
    const auto idle = support::spawn(loop_.executor(), outputs_.until_idle());
    loop_.settle();
    EXPECT_TRUE(*idle);
    for (Bus* bus : {&bus_, &drive_}) {
      const auto stopped = support::spawn(loop_.executor(), bus->stop());
      loop_.settle();
      EXPECT_TRUE(*stopped);
    }
  }

  static BusSettings without_heartbeat() { return {.heartbeat = Duration::zero()}; }
  /// Its heartbeat is the sign of life that commands need.
  static BusSettings drive() { return {.node_id = kNode}; }

  Sent send(std::vector<ObjectValue> fields, Duration within = 800ms) {
    return support::spawn(loop_.executor(), outputs_.send(1, std::move(fields), Clock::now() + within));
  }
  /// Control 15 and target 100 have left, and the record begins with that.
  void run() {
    const Sent sent = send({control(15), target(100)});
    loop_.settle();
    ASSERT_TRUE(sent.done());
    ASSERT_TRUE(sent.get().has_value());
    begin_record();
  }
  void begin_record() {
    begun_ = Clock::now();
    heard_.clear();
  }
  /// An SDO write that the drive answers `after` its request has left.
  std::shared_ptr<bool> write(const ObjectValue& value, Duration after) {
    return support::spawn(loop_.executor(), write_and_note(value, after));
  }
  [[nodiscard]] Duration longest_gap() const {
    Duration longest = Clock::now() - begun_ - (heard_.empty() ? Duration::zero() : heard_.back().first);
    Duration last{};
    for (const Heard& each : heard_) {
      longest = std::max(longest, each.first - last);
      last = each.first;
    }
    return longest;
  }

  support::HandDrivenLoop loop_;
  VirtualBus wire_{loop_.executor()};
  bool closed_ = false;  ///< Nothing of ours can leave.
  Bus bus_{loop_.executor(), std::make_unique<support::GatedLink>(wire_.connect(), closed_), without_heartbeat()};
  Bus drive_{loop_.executor(), wire_.connect(), drive()};
  TimePoint begun_{};
  std::vector<Heard> heard_;
  Subscription rpdos_ = drive_.subscribe(0x205, [this](const Received& received) {
    heard_.push_back({received.at - begun_, {received.frame.data[0], received.frame.data[2]}});
  });
  std::vector<PdoSettings> settings_{supervised()};
  Outputs outputs_{loop_.executor(), bus_, kNode, settings_};

 private:
  boost::asio::awaitable<void> write_and_note(ObjectValue value, Duration after) {
    outputs_.hold(value.object);
    const Result<void> left = co_await request();
    if (left.has_value()) {
      Timer answer(loop_.executor(), after);
      co_await answer.async_wait(boost::asio::use_awaitable);
      outputs_.note(value);
    }
  }
  boost::asio::awaitable<Result<void>> request() {
    const Frame frame = make_frame(0x605, std::vector<std::uint8_t>(8, 0x2B));
    Transmission sending(bus_, TransmitClass::command, frame, Clock::now() + 800ms);
    co_return co_await sending.result();
  }
};

TEST_F(OutputsTest, ARepetitionComesThreeTimesPerEventTimer) {
  run();
  loop_.advance(350ms);
  EXPECT_EQ(heard_, (std::vector<Heard>{{100ms, {15, 100}}, {200ms, {15, 100}}, {300ms, {15, 100}}}));
}

TEST_F(OutputsTest, WhatWasHeldBackFollowsAtOnceWithTheNewValue) {
  run();
  loop_.advance(95ms);
  const auto written = write(target(50), 20ms);
  loop_.advance(135ms);
  EXPECT_TRUE(*written);
  EXPECT_EQ(heard_, (std::vector<Heard>{{115ms, {15, 50}}, {215ms, {15, 50}}}));
}

TEST_F(OutputsTest, AWriteBetweenTwoRepetitionsAddsNone) {
  run();
  loop_.advance(20ms);
  const auto written = write(target(50), 20ms);
  loop_.advance(190ms);
  EXPECT_TRUE(*written);
  EXPECT_EQ(heard_, (std::vector<Heard>{{100ms, {15, 50}}, {200ms, {15, 50}}}));
}

TEST_F(OutputsTest, ARepetitionThatWaitsGivesWayToAWriteAndFollowsItAtOnce) {
  run();
  closed_ = true;
  loop_.advance(105ms);  // A repetition waits.
  const auto written = write(target(50), 2ms);
  loop_.advance(5ms);
  closed_ = false;
  loop_.advance(40ms);
  EXPECT_TRUE(*written);
  ASSERT_EQ(heard_.size(), 1U);
  EXPECT_EQ(heard_[0].second, (std::vector<int>{15, 50}));
}

TEST_F(OutputsTest, AWriteThatTakesLongHoldsBackForOnePeriod) {
  run();
  loop_.advance(90ms);
  const auto written = write(target(50), 175ms);
  for (int i = 0; i < 4; ++i) {
    loop_.advance(20ms);
    outputs_.hold(kTarget);  // Further writes wait behind it.
  }
  loop_.advance(130ms);
  EXPECT_TRUE(*written);
  // At 190 with the value of before: the drive would trip otherwise. So the new one is due again once it is confirmed.
  ASSERT_EQ(heard_.size(), 2U);
  EXPECT_EQ(heard_[0], (Heard{190ms, {15, 100}}));
  EXPECT_EQ(heard_[1], (Heard{265ms, {15, 50}}));
}

TEST_F(OutputsTest, ARefusedWriteHoldsBackForOnePeriod) {
  run();
  loop_.advance(90ms);
  outputs_.hold(kTarget);
  loop_.advance(220ms);
  EXPECT_EQ(heard_, (std::vector<Heard>{{190ms, {15, 100}}, {290ms, {15, 100}}}));
}

TEST_F(OutputsTest, NothingFollowsAWriteDuringWhichTheMotorFaulted) {
  run();
  loop_.advance(95ms);
  const auto written = write(target(50), 20ms);
  loop_.advance(10ms);
  outputs_.make_void(false);
  loop_.advance(1s);
  EXPECT_TRUE(*written);
  EXPECT_TRUE(heard_.empty());
}

TEST_F(OutputsTest, NothingFollowsAWriteWhoseValueIsForgotten) {
  run();
  closed_ = true;
  loop_.advance(105ms);  // A repetition waits.
  outputs_.hold(kControl);
  outputs_.forget(kControl);
  closed_ = false;
  loop_.advance(1s);
  EXPECT_TRUE(heard_.empty());
}

/// When writes begin beside the repetitions, how long the drive takes for one, how long nothing leaves before each.
class OutputsUnderWritesTest : public OutputsTest, public testing::WithParamInterface<std::tuple<int, int, int>> {};

TEST_P(OutputsUnderWritesTest, NoGapIsLongerThanTheEventTimer) {
  const auto [every, answer, blocked] = GetParam();
  run();
  Raw value = 0;
  std::shared_ptr<bool> writing;
  std::size_t writes = 0;
  for (int ms = 1; ms <= 2000; ++ms) {
    closed_ = ms % every >= every - blocked;
    if (ms % every == every - 1 && (!writing || *writing)) {
      value = (value + 1) % 200;
      writing = write(target(value), std::chrono::milliseconds(answer));
      ++writes;
    }
    loop_.advance(1ms);
  }
  EXPECT_GE(writes, 6U);
  EXPECT_LE(longest_gap(), kEventTimer - std::chrono::milliseconds(blocked));
  EXPECT_LE(longest_gap(), 2 * kPeriod + std::chrono::milliseconds(2 * blocked));
}

INSTANTIATE_TEST_SUITE_P(AtEachRepetition, OutputsUnderWritesTest,
                         testing::Combine(testing::Values(20, 33, 97, 99, 100, 101, 150),
                                          testing::Values(0, 2, 90, 250), testing::Values(0, 3, 10)));

TEST_F(OutputsTest, AWriteEachTimeARepetitionWaitsDoesNotStopIt) {
  run();
  for (int i = 0; i < 20; ++i) {
    // As others' commands do: the repetition waits, and a write is queued in front of it.
    const std::size_t before = heard_.size();
    closed_ = true;
    loop_.advance(i == 0 ? 101ms : 99ms);
    ASSERT_EQ(heard_.size(), before);
    const auto written = write(target(static_cast<Raw>(i)), 2ms);
    loop_.advance(1ms);
    closed_ = false;
    loop_.advance(40ms);  // The queue tries again after 32 ms at the latest.
    ASSERT_TRUE(*written);
    ASSERT_EQ(heard_.size(), before + 1);
    EXPECT_EQ(heard_.back().second, (std::vector<int>{15, i}));
  }
  EXPECT_LE(longest_gap(), 2 * kPeriod);
}

TEST_F(OutputsTest, AStandstillWithdrawsWhatReliesOnItAndTheRepetitionGoesOn) {
  run();
  closed_ = true;
  loop_.advance(50ms);
  const Sent sent = send({target(50)});
  loop_.advance(100ms);
  outputs_.make_void(true);
  loop_.settle();
  ASSERT_TRUE(sent.done());
  EXPECT_EQ(sent.get().error().kind, ErrorKind::incomplete);
  closed_ = false;
  loop_.advance(40ms);
  ASSERT_EQ(heard_.size(), 1U);
  EXPECT_EQ(heard_[0].second, (std::vector<int>{15, 100}));
}

TEST_F(OutputsTest, AStandstillLetsGoWhatWasGivenAnew) {
  run();
  closed_ = true;
  const Sent sent = send({control(6), target(0)});
  loop_.advance(10ms);
  outputs_.make_void(true);
  closed_ = false;
  loop_.advance(140ms);
  ASSERT_TRUE(sent.done());
  EXPECT_TRUE(sent.get().has_value());
  EXPECT_FALSE(outputs_.complete(1, std::vector<ObjectValue>{target(50)})) << "it does not count";
  ASSERT_EQ(heard_.size(), 2U);
  EXPECT_EQ(heard_[0].second, (std::vector<int>{6, 0}));
  EXPECT_EQ(heard_[1].second, (std::vector<int>{6, 0}));
}

TEST_F(OutputsTest, AFaultLetsGoWhatWasGivenAnewButDoesNotRepeatIt) {
  run();
  closed_ = true;
  const Sent sent = send({control(6), target(0)});
  loop_.advance(10ms);
  outputs_.make_void(false);
  closed_ = false;
  loop_.advance(1s);
  ASSERT_TRUE(sent.done());
  EXPECT_TRUE(sent.get().has_value());
  EXPECT_EQ(heard_.size(), 1U);
}

TEST_F(OutputsTest, WhatMayGoAfterAStandstillAndDoesNotInTimeTimedOut) {
  run();
  closed_ = true;
  const Sent sent = send({control(6), target(0)}, 50ms);
  loop_.advance(10ms);
  outputs_.make_void(true);
  loop_.advance(50ms);
  ASSERT_TRUE(sent.done());
  EXPECT_EQ(sent.get().error().kind, ErrorKind::timeout);
}

TEST_F(OutputsTest, AnEndWithdrawsTheWholeLine) {
  run();
  closed_ = true;
  const Sent first = send({target(50)});
  const Sent second = send({control(6), target(0)});
  loop_.advance(10ms);
  outputs_.cease();
  loop_.settle();
  ASSERT_TRUE(first.done() && second.done());
  for (const Sent& sent : {first, second}) {
    EXPECT_EQ(sent.get().error().kind, ErrorKind::offline);
    EXPECT_FALSE(sent.get().error().outcome_unknown);
    EXPECT_EQ(sent.get().error().node, kNode);
  }
  closed_ = false;
  loop_.advance(1s);
  EXPECT_TRUE(heard_.empty());
}

TEST_F(OutputsTest, OneThatHasNoTurnInTimeIsNotBegun) {
  run();
  closed_ = true;
  const Sent first = send({target(50)});
  const Sent second = send({control(6)}, 20ms);
  loop_.advance(20ms);
  ASSERT_TRUE(second.done());
  EXPECT_EQ(second.get().error().kind, ErrorKind::timeout);
  EXPECT_FALSE(second.get().error().outcome_unknown);
  EXPECT_FALSE(first.done());
}

TEST_F(OutputsTest, AnRpdoWhoseEchoIsMissingIsNotRepeated) {
  run();
  wire_.withhold_echoes(true);
  const Sent sent = send({control(6)}, 50ms);
  loop_.advance(50ms);
  ASSERT_TRUE(sent.done());
  EXPECT_TRUE(sent.get().error().outcome_unknown);
  wire_.withhold_echoes(false);
  EXPECT_FALSE(outputs_.complete(1, std::vector<ObjectValue>{target(50)}));
  heard_.clear();
  loop_.advance(3s);
  EXPECT_TRUE(heard_.empty());
}

}  // namespace
}  // namespace canopen
