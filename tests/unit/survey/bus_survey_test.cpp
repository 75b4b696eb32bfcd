#include "canopen/survey/bus_survey.h"

#include <gmock/gmock.h>
#include <linux/can/error.h>

#include <memory>
#include <string>
#include <vector>

#include "canopen/bus/bus.h"
#include "tests/support/bus_fixture.h"
#include "tests/support/frame.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr std::uint8_t kNode = 5;
constexpr std::uint8_t kOperational = 5;

class BusSurveyTest : public testing::Test {
 protected:
  BusSurveyTest()
      : bus_(loop_.executor(), std::make_unique<support::HandLink>(events_), support::kQuiet),
        survey_(loop_.executor(), bus_,
                {.known = [this] { return known_; },
                 .began = [this](const Suspicion& began,
                                 const auto& /*displaced*/) { told_.push_back("began: " + began.text()); },
                 .ended = [this](const Suspicion& ended) { told_.push_back("ended: " + ended.text()); }}) {
    known_.served.set(kNode);
    survey_.set_timeout(kNode, 2s);
    bus_.start();
    survey_.start();
    be({.condition = BusCondition::error_active});
  }
  ~BusSurveyTest() override { survey_.stop(); }

  void be(const BusState& state) { events_->on_bus_state(state); }
  static Received now(const Frame& frame) { return {frame, Clock::now(), wall_now()}; }
  void hear(const Frame& heard) {
    const Received received = now(heard);
    events_->on_frames({&received, 1});
  }
  void error(unsigned kind, std::uint32_t classes = CAN_ERR_PROT | CAN_ERR_BUSERROR) {
    Frame frame{.id = classes, .size = 8, .error = true};
    frame.data[2] = static_cast<std::uint8_t>(kind);
    events_->on_error_frame(now(frame), ErrorSign::other);
  }
  /// A TPDO each 20 ms, a heartbeat each 500 ms.
  void traffic(Duration time) {
    for (int i = 0; i < time / 20ms; ++i) {
      if (i % 25 == 0) {
        hear(frame(0x705, kOperational));
      }
      hear(frame(0x185));
      loop_.advance(20ms, 20ms);
    }
  }
  [[nodiscard]] std::string kind() const {
    const BusHealth health = survey_.health();
    return health.suspicion ? std::string(name_of(health.suspicion->kind)) : "none";
  }

  support::HandDrivenLoop loop_;
  LinkEvents* events_ = nullptr;
  BusSurvey::Known known_;
  std::vector<std::string> told_;
  Bus bus_;
  BusSurvey survey_;
};

TEST_F(BusSurveyTest, OfACleanBusThereAreFiguresAndNoSuspicion) {
  loop_.advance(1s);
  traffic(60s);
  const BusHealth health = survey_.health();
  EXPECT_FALSE(health.suspicion);
  EXPECT_THAT(told_, IsEmpty());
  EXPECT_EQ(health.transmit_errors, (Extremes{0, 0}));
  EXPECT_EQ(health.errors, (Extremes{0, 0}));
  ASSERT_TRUE(health.load);
  EXPECT_EQ(health.load->most, bus_.statistics().highest_load_per_mille);
  ASSERT_EQ(health.nodes.size(), 1U);
  EXPECT_NEAR(health.nodes[0].worst_margin().value(), 0.75, 0.01);
  EXPECT_EQ(worst_node(health)->node, kNode);
  EXPECT_EQ(health.burst->frames, 2U) << "heartbeat and TPDO of one moment";
  const std::vector<PeriodHealth> periods = survey_.periods();
  ASSERT_EQ(periods.size(), 2U);
  EXPECT_EQ(periods[0].cob_id, 0x185U);
  EXPECT_NEAR(static_cast<double>(periods[0].period.p99.count()), 20e6, 20e6 / 16);
  EXPECT_EQ(periods[1].cob_id, 0x705U);
}

TEST_F(BusSurveyTest, OurEchoIsTheRequestThatAnAnswerIsTimedFrom) {
  events_->on_echo(now(frame(0x605, 0x40)));
  loop_.advance(3ms);
  hear(frame(0x585, 0x43));
  hear(frame(0x605, 0x40));  // Another client's.
  loop_.advance(50ms);
  hear(frame(0x585, 0x43));
  ASSERT_EQ(survey_.health().nodes.size(), 1U);
  EXPECT_EQ(survey_.health().nodes[0].answers.count, 1U);
  EXPECT_NEAR(static_cast<double>(survey_.health().nodes[0].answers.p99.count()), 3e6, 3e6 / 16);
}

TEST_F(BusSurveyTest, LostFramesAndABusThatWasAwayAreNoGapOfADrive) {
  traffic(3s);
  loop_.advance(1700ms);
  events_->on_frames_lost(1);
  traffic(3s);
  be({.condition = BusCondition::bus_off});
  loop_.advance(1800ms);
  be({.condition = BusCondition::error_active});
  traffic(3s);
  EXPECT_NEAR(survey_.health().nodes[0].worst_margin().value(), 0.75, 0.01);
  EXPECT_LT(survey_.periods()[0].worst, 21ms);
  loop_.advance(1500ms);
  traffic(1s);
  EXPECT_LT(survey_.health().nodes[0].worst_margin().value(), 0.25) << "this one is its own";
}

TEST_F(BusSurveyTest, ADriveThatWasOffHasNoPeriodAcrossThat) {
  traffic(3s);
  loop_.advance(1900ms);
  hear(frame(0x705, 0));
  traffic(3s);
  loop_.advance(500ms);
  hear(frame(0x705, 4));  // Stopped.
  loop_.advance(1s);
  traffic(3s);
  known_.served.reset(kNode);
  loop_.advance(30min, 1min);
  known_.served.set(kNode);
  traffic(3s);
  ASSERT_EQ(survey_.periods().size(), 2U);
  EXPECT_LT(survey_.periods()[0].worst, 21ms);
  EXPECT_LT(survey_.periods()[1].worst, 501ms);
  loop_.advance(700ms);
  traffic(1s);
  EXPECT_GT(survey_.periods()[0].worst, 700ms) << "this one is its own";
}

TEST_F(BusSurveyTest, CountersAndErrorsOfADay) {
  traffic(2s);
  be({.condition = BusCondition::error_active, .transmit_errors = 8, .receive_errors = 40});
  error(CAN_ERR_PROT_FORM);
  traffic(2s);
  be({.condition = BusCondition::error_active, .transmit_errors = 3, .receive_errors = 0});
  traffic(2s);
  EXPECT_EQ(survey_.health().transmit_errors, (Extremes{0, 8}));
  EXPECT_EQ(survey_.health().receive_errors, (Extremes{0, 40}));
  EXPECT_EQ(survey_.health().errors, (Extremes{0, 1}));
  loop_.advance(25h, 1min);
  EXPECT_EQ(survey_.health().transmit_errors, (Extremes{3, 3}));
  EXPECT_EQ(survey_.health().receive_errors, (Extremes{0, 0}));
  EXPECT_EQ(survey_.health().errors, (Extremes{1, 1})) << "no further frame came";
  EXPECT_FALSE(survey_.health().nodes[0].longest_gap);
}

TEST_F(BusSurveyTest, WhereNothingWasEverReadableTheBitRateIsSuspected) {
  for (int i = 0; i < 5; ++i) {
    error(CAN_ERR_PROT_STUFF);
    error(CAN_ERR_PROT_FORM);
    be({.condition = BusCondition::passive, .receive_errors = 130});
    loop_.advance(1s);
  }
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_THAT(told_[0], HasSubstr("began: the bit rate may be wrong"));
  EXPECT_THAT(told_[0], HasSubstr("here 125000 bit/s"));
  EXPECT_THAT(told_[0], HasSubstr("since the gateway opened the interface")) << "it was up before";
  be({.condition = BusCondition::error_active});
  traffic(30s);
  EXPECT_EQ(kind(), "bit_rate") << "it is not forgotten at once";
  traffic(40s);
  EXPECT_EQ(kind(), "none");
  EXPECT_EQ(told_.size(), 2U);
  EXPECT_THAT(told_[1], HasSubstr("ended: the bit rate may be wrong"));
}

TEST_F(BusSurveyTest, WhereErrorsComeWithFramesTheWiringIsSuspected) {
  traffic(5s);
  for (int i = 0; i < 10; ++i) {
    error(i % 2 == 0 ? CAN_ERR_PROT_STUFF : CAN_ERR_PROT_BIT);
    traffic(500ms);
  }
  traffic(3s);
  EXPECT_THAT(told_, ElementsAre(HasSubstr("began: wiring or termination may be bad: 10 errors in the last minute")));
  traffic(10min);
  EXPECT_EQ(kind(), "wiring") << "it comes and goes";
  EXPECT_THAT(suspicion_text(survey_.health()),
              ContainsRegex("^wiring or termination may be bad, seen until 5[0-9][0-9] s ago: [1-9][0-9]* errors in"))
      << "nothing of it is now";
  traffic(2min);
  EXPECT_EQ(kind(), "none");
  EXPECT_EQ(told_.size(), 2U);
}

TEST_F(BusSurveyTest, ErrorsOfBeforeAStopOfTheProcessAreNotOfTheLastMinute) {
  traffic(2s);
  for (int i = 0; i < 9; ++i) {
    error(CAN_ERR_PROT_STUFF);
  }
  traffic(2s);
  loop_.advance(2min, 2min);
  error(CAN_ERR_PROT_STUFF);
  traffic(6s);
  EXPECT_EQ(kind(), "none");
}

TEST_F(BusSurveyTest, AControllerThatComesAndGoesIsSuspectedToo) {
  const auto stumble = [this] {
    be({.condition = BusCondition::warning, .receive_errors = 100});
    be({.condition = BusCondition::passive, .receive_errors = 130});
    be({.condition = BusCondition::error_active});
    traffic(60s);
  };
  traffic(1s);
  stumble();
  stumble();
  EXPECT_EQ(kind(), "none");
  stumble();
  EXPECT_EQ(kind(), "wiring");
}

TEST_F(BusSurveyTest, ADriveThatIsSwitchedOffAndOnIsNoBadWire) {
  traffic(1s);
  for (int i = 0; i < 4; ++i) {
    be({.condition = BusCondition::warning, .transmit_errors = 96});
    be({.condition = BusCondition::passive, .transmit_errors = 128});
    loop_.advance(1s);
    known_.troubles.transmit = TransmitTrouble::not_acknowledged;
    loop_.advance(4s);
    EXPECT_EQ(kind(), "alone");
    known_.troubles.transmit = TransmitTrouble::none;
    traffic(1s);
    be({.condition = BusCondition::warning, .transmit_errors = 127});
    traffic(3s);
    be({.condition = BusCondition::error_active, .transmit_errors = 95});
    traffic(100s);
    EXPECT_EQ(kind(), "none") << i;
  }
  for (const std::string& told : told_) {
    EXPECT_THAT(told, Not(HasSubstr("wiring")));
  }
}

TEST_F(BusSurveyTest, WhatOthersKnowIsSaid) {
  traffic(2s);
  known_.doubled = DoubledSign{.node = kNode, .text = "two devices answer"};
  traffic(4s);
  EXPECT_EQ(kind(), "doubled_id");
  known_.doubled.reset();
  known_.troubles.overload = true;
  traffic(20s);
  EXPECT_EQ(kind(), "overload");
  EXPECT_THAT(told_.back(), HasSubstr("the most frequent COB-ID is 0x185, every"));
  known_.troubles = {};
  traffic(70s);
  EXPECT_EQ(kind(), "none");
}

TEST_F(BusSurveyTest, WhoIsSilentForAMinuteIsNotTheBusiest) {
  for (int i = 0; i < 10; ++i) {
    hear(frame(0x18F));
    loop_.advance(1ms);
  }
  loop_.advance(61s, 1s);
  known_.troubles.overload = true;
  traffic(4s);
  ASSERT_EQ(told_.size(), 1U);
  EXPECT_THAT(told_[0], HasSubstr("COB-ID is 0x185"));
}

TEST_F(BusSurveyTest, WhereNobodyAcknowledgesItSaysSo) {
  known_.troubles.transmit = TransmitTrouble::not_acknowledged;
  be({.condition = BusCondition::passive, .transmit_errors = 128});
  for (int i = 0; i < 5; ++i) {
    error(0, CAN_ERR_ACK);
    loop_.advance(1s);
  }
  EXPECT_EQ(kind(), "alone");
  EXPECT_EQ(survey_.health().suspected_since, wall_now() - 2s);
}

TEST_F(BusSurveyTest, AnInterfaceThatComesBackIsLookedAtAnew) {
  traffic(2s);
  be({.condition = BusCondition::down});
  loop_.advance(20s);
  be({.condition = BusCondition::error_active});
  be({.condition = BusCondition::passive, .receive_errors = 135});
  loop_.advance(4s);
  EXPECT_EQ(kind(), "bit_rate") << "what was heard was before";
  EXPECT_THAT(told_.back(), HasSubstr("since the interface came up"));
}

TEST_F(BusSurveyTest, OfAnInterfaceThatWentDownNothingIsSuspected) {
  traffic(5s);
  known_.doubled = DoubledSign{.node = kNode, .text = "two devices answer"};
  traffic(4s);
  EXPECT_EQ(suspicion_text(survey_.health()), survey_.health().suspicion->text()) << "it is shown now";
  known_.doubled.reset();
  be({.condition = BusCondition::down});
  EXPECT_EQ(kind(), "none");
  EXPECT_EQ(suspicion_text(survey_.health()), "");
  be({.condition = BusCondition::error_active});
  traffic(5s);
  EXPECT_EQ(kind(), "none");
  EXPECT_THAT(told_, ElementsAre(HasSubstr("began: a node id may"), HasSubstr("ended: a node id may")));
}

TEST_F(BusSurveyTest, WithoutABitRateThereIsNoLoadAndNoBurst) {
  LinkEvents* events = nullptr;
  Bus bus(loop_.executor(), std::make_unique<support::HandLink>(events), {.node_id = 0, .heartbeat = {}});
  BusSurvey survey(loop_.executor(), bus, {.known = [] { return BusSurvey::Known{}; }});
  bus.start();
  survey.start();
  events->on_bus_state({.condition = BusCondition::error_active});
  for (int i = 0; i < 3; ++i) {
    const Received received = now(frame(0x185));
    events->on_frames({&received, 1});
    loop_.advance(1s);
  }
  EXPECT_FALSE(survey.health().load);
  EXPECT_FALSE(survey.health().burst);
  EXPECT_EQ(survey.periods().size(), 1U);
  EXPECT_EQ(worst_node(survey.health()), nullptr);
  events->on_bit_timing({.bitrate = 500'000});
  const Received received = now(frame(0x185));
  events->on_frames({&received, 1});
  loop_.advance(2s);
  EXPECT_TRUE(survey.health().load);
  EXPECT_EQ(survey.health().burst->frames, 1U);
}

}  // namespace
}  // namespace canopen
