#include "canopen/survey/bus_survey.h"

#include <gmock/gmock.h>

#include "tests/unit/survey/surveyed_bus.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;
using test::kNode;
using testing::IsEmpty;

class BusSurveyTest : public test::SurveyedBus {};

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
