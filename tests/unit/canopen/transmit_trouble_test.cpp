// Why frames of ours do not leave: by what is known of them, and by what a bus tells.

#include "canopen/bus/transmit_trouble.h"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/bus_watch.h"
#include "tests/support/frame.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

const TimePoint kThen{1h};

struct SignsCase {
  const char* name;
  BusState state;
  std::optional<Duration> unsent;     ///< Ago.
  std::optional<Duration> ack_error;  ///< Ago.
  Duration silent;                    ///< For so long.
  TransmitTrouble trouble;
};

std::ostream& operator<<(std::ostream& out, const SignsCase& one) {
  return out << one.name;
}

class TransmitTroubleTest : public ::testing::TestWithParam<SignsCase> {};

TEST_P(TransmitTroubleTest, IsAsTheTableSays) {
  const SignsCase& one = GetParam();
  TransmitSigns signs{.state = one.state, .silent_since = kThen - one.silent};
  if (one.unsent) {
    signs.unsent_since = kThen - *one.unsent;
  }
  if (one.ack_error) {
    signs.ack_error_at = kThen - *one.ack_error;
  }
  EXPECT_EQ(judge_transmission(signs, kThen), one.trouble);
}

constexpr BusState kUp{BusCondition::error_active, 0, 0};
constexpr BusState kPassiveBySending{BusCondition::passive, 128, 0};

INSTANTIATE_TEST_SUITE_P(
    Signs, TransmitTroubleTest,
    ::testing::Values(
        SignsCase{"NothingIsWrong", kUp, {}, {}, 0s, TransmitTrouble::none},
        SignsCase{"ASilentBusIsNone", kUp, {}, {}, 1h, TransmitTrouble::none},
        SignsCase{"AnAckErrorOnASilentBus", kUp, {}, 0s, 1s, TransmitTrouble::not_acknowledged},
        SignsCase{"AnAckErrorWhileOthersAreHeard", kUp, {}, 0s, 999ms, TransmitTrouble::none},
        SignsCase{"AnAckErrorOfLongAgo", kUp, {}, 10s, 1h, TransmitTrouble::none},
        SignsCase{"PassiveBySending", kPassiveBySending, {}, {}, 1s, TransmitTrouble::not_acknowledged},
        SignsCase{"PassiveBySendingWhileOthersAreHeard", kPassiveBySending, {}, {}, 0s, TransmitTrouble::none},
        SignsCase{"PassiveByDisturbedWires", {BusCondition::passive, 128, 130}, {}, {}, 1h, TransmitTrouble::none},
        SignsCase{"PassiveByReceiving", {BusCondition::passive, 3, 130}, {}, {}, 1h, TransmitTrouble::none},
        SignsCase{"ManyTransmitErrorsOnly", {BusCondition::warning, 127, 0}, {}, {}, 1h, TransmitTrouble::none},
        SignsCase{"StuckForASecond", kUp, 1s, {}, 0s, TransmitTrouble::stuck},
        SignsCase{"StuckForLess", kUp, 999ms, {}, 1h, TransmitTrouble::none},
        SignsCase{"StuckForNobodyAcknowledges", kPassiveBySending, 5s, {}, 5s, TransmitTrouble::not_acknowledged},
        SignsCase{"StuckOnABadBus", {BusCondition::passive, 128, 130}, 5s, {}, 5s, TransmitTrouble::stuck},
        SignsCase{"BusOff", {BusCondition::bus_off, 255, 0}, 5s, 0s, 5s, TransmitTrouble::none},
        SignsCase{"Down", {}, 5s, 0s, 5s, TransmitTrouble::none}),
    ::testing::PrintToStringParamName());

/// A bus whose link does what a test says.
class TransmitWatchTest : public ::testing::Test {
 protected:
  class Wire final : public Link {
   public:
    explicit Wire(TransmitWatchTest& test) : test_(test) {}
    void open(LinkEvents& events) override { test_.events_ = &events; }
    void close() override { test_.events_ = nullptr; }
    SendResult send(const Frame& frame) override {
      if (test_.result_ == SendResult::handed_over) {
        ++test_.handed_over_;
        test_.last_ = frame;
      }
      return test_.result_;
    }
    TimePoint heard_until() override { return test_.heard_until_.value_or(Clock::now()); }
    [[nodiscard]] bool echoes_prove_departure() const noexcept override { return test_.proves_departure_; }

   private:
    TransmitWatchTest& test_;
  };

  TransmitWatchTest() {
    bus_.start();
    watch_.start();
    events_->on_bus_state({BusCondition::error_active, 0, 0});
    loop_.settle();
  }
  ~TransmitWatchTest() override {
    watch_.stop();
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }

  /// What leaves is echoed.
  void echo() {
    if (handed_over_ > 0) {
      handed_over_ = 0;
      events_->on_echo({last_, Clock::now(), {}});
    }
  }
  void hear() {
    const Received received{support::frame(0x185), Clock::now(), wall_now()};
    events_->on_frames({&received, 1});
  }
  void live(Duration time, bool with_echoes, bool with_others) {
    for (Duration passed{}; passed < time; passed += 100ms) {
      loop_.advance(100ms, 10ms);
      if (with_echoes) {
        echo();
      }
      if (with_others) {
        hear();
      }
    }
    loop_.advance(200ms, 10ms);
  }
  [[nodiscard]] TransmitTrouble now() const { return told_.empty() ? TransmitTrouble::none : told_.back().transmit; }

  support::HandDrivenLoop loop_;
  LinkEvents* events_ = nullptr;
  SendResult result_ = SendResult::handed_over;
  bool proves_departure_ = true;
  int handed_over_ = 0;
  Frame last_{};
  std::optional<TimePoint> heard_until_;
  Bus bus_{loop_.executor(), std::make_unique<Wire>(*this), {.bitrate = 125000, .node_id = 127, .heartbeat = 500ms}};
  std::vector<BusTroubles> told_;
  BusWatch watch_{loop_.executor(), bus_, false,
                  BusWatch::Handlers{.changed = [this](const BusTroubles& troubles) { told_.push_back(troubles); },
                                     .remark = [](const std::string&) {}}};
};

TEST_F(TransmitWatchTest, ABusThatLivesHasNone) {
  live(10s, true, true);
  live(10s, true, false);  // All drives are switched off, and something acknowledges.
  EXPECT_TRUE(told_.empty());
}

TEST_F(TransmitWatchTest, ABufferThatStaysFullIsToldUntilAFrameLeaves) {
  live(2s, true, true);
  result_ = SendResult::busy;
  live(700ms, false, true);
  EXPECT_EQ(now(), TransmitTrouble::none);
  live(2s, false, true);
  EXPECT_EQ(now(), TransmitTrouble::stuck);
  result_ = SendResult::handed_over;
  live(1s, true, true);
  EXPECT_EQ(now(), TransmitTrouble::none);
  EXPECT_EQ(told_.size(), 2U);
}

TEST_F(TransmitWatchTest, SoAreFramesThatGetNoEcho) {
  live(3s, false, true);
  EXPECT_EQ(now(), TransmitTrouble::stuck);
}

TEST_F(TransmitWatchTest, NobodyAcknowledgesUntilSomebodyIsHeard) {
  for (int i = 0; i < 20; ++i) {
    events_->on_error_frame({}, ErrorSign::not_acknowledged);
    loop_.advance(100ms, 10ms);
  }
  EXPECT_EQ(now(), TransmitTrouble::not_acknowledged);
  EXPECT_EQ(told_.size(), 1U) << "not one for each frame";
  echo();
  live(300ms, true, true);
  EXPECT_EQ(now(), TransmitTrouble::none);
}

// An echo that proves departure is the acknowledgement: drives whose heartbeats are slow make it no alarm that comes
// and goes.
TEST_F(TransmitWatchTest, AFrameThatHasLeftWasAcknowledged) {
  for (int i = 0; i < 20; ++i) {
    events_->on_error_frame({}, ErrorSign::not_acknowledged);
    loop_.advance(100ms, 10ms);
  }
  ASSERT_EQ(now(), TransmitTrouble::not_acknowledged);
  echo();
  hear();
  for (int i = 0; i < 5; ++i) {
    live(2s, true, false);
    hear();
  }
  EXPECT_EQ(now(), TransmitTrouble::none);
  EXPECT_EQ(told_.size(), 2U);
}

TEST_F(TransmitWatchTest, ASingleAckErrorOnAQuietBusIsNone) {
  live(2s, true, false);
  events_->on_error_frame({}, ErrorSign::not_acknowledged);
  live(5s, true, false);
  EXPECT_TRUE(told_.empty());
}

TEST_F(TransmitWatchTest, AnEchoOfAnAdapterThatOnlyTookTheFrameIsNoAcknowledgement) {
  proves_departure_ = false;
  for (int i = 0; i < 20; ++i) {
    events_->on_error_frame({}, ErrorSign::not_acknowledged);
    loop_.advance(100ms, 10ms);
    echo();
  }
  live(5s, true, false);
  EXPECT_EQ(now(), TransmitTrouble::not_acknowledged);
}

TEST_F(TransmitWatchTest, OtherErrorFramesAreNoSignOfIt) {
  for (int i = 0; i < 20; ++i) {
    events_->on_error_frame({}, ErrorSign::other);
    loop_.advance(100ms, 10ms);
    echo();
  }
  EXPECT_TRUE(told_.empty());
}

// The echo, and what others sent, may wait in the socket.
TEST_F(TransmitWatchTest, AStallOfTheProcessIsNone) {
  live(2s, true, true);
  heard_until_ = Clock::now();
  events_->on_error_frame({}, ErrorSign::not_acknowledged);
  loop_.advance(5s, 10ms);
  EXPECT_TRUE(told_.empty());
}

TEST_F(TransmitWatchTest, LostFramesMayHaveBeenEchoes) {
  live(2s, true, true);
  loop_.advance(600ms, 10ms);  // A heartbeat leaves, and its echo is lost.
  handed_over_ = 0;
  events_->on_frames_lost(3);
  loop_.advance(900ms, 10ms);  // 1.2 s after that heartbeat, and 0.7 s after the next one.
  EXPECT_TRUE(told_.empty());
}

class SilentGatewayTest : public ::testing::Test {
 protected:
  class FullLink final : public Link {
   public:
    void open(LinkEvents& events) override { events.on_bus_state({BusCondition::error_active, 0, 0}); }
    void close() override {}
    SendResult send(const Frame&) override { return SendResult::busy; }
  };

  SilentGatewayTest() { bus_.start(); }
  ~SilentGatewayTest() override {
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }

  support::HandDrivenLoop loop_;
  Bus bus_{loop_.executor(), std::make_unique<FullLink>(), {.bitrate = 125000, .node_id = 0}};
};

// Without a heartbeat nothing of ours may leave for hours, and none of it is stuck.
TEST_F(SilentGatewayTest, WhatWasWithdrawnIsNotStuck) {
  const Ticket ticket = bus_.send(TransmitClass::sdo, support::frame(0x605), Clock::now() + 500ms);
  loop_.advance(400ms, 10ms);
  EXPECT_TRUE(bus_.transmit_signs().unsent_since);
  loop_.advance(2s, 10ms);
  EXPECT_FALSE(bus_.transmit_signs().unsent_since);
}

TEST_F(TransmitWatchTest, ABusThatWentDownHasNone) {
  live(3s, false, true);
  ASSERT_EQ(now(), TransmitTrouble::stuck);
  events_->on_bus_state({});
  loop_.advance(300ms, 10ms);
  EXPECT_EQ(now(), TransmitTrouble::none);
}

}  // namespace
}  // namespace canopen
