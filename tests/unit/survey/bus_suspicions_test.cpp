// What a survey suspects of a bus.
#include <gmock/gmock.h>

#include <string>

#include "tests/unit/survey/surveyed_bus.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;
using test::kNode;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class BusSuspicionsTest : public test::SurveyedBus {};

TEST_F(BusSuspicionsTest, WhereNothingWasEverReadableTheBitRateIsSuspected) {
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

TEST_F(BusSuspicionsTest, WhereErrorsComeWithFramesTheWiringIsSuspected) {
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

TEST_F(BusSuspicionsTest, ErrorsOfBeforeAStopOfTheProcessAreNotOfTheLastMinute) {
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

TEST_F(BusSuspicionsTest, AControllerThatComesAndGoesIsSuspectedToo) {
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

TEST_F(BusSuspicionsTest, ADriveThatIsSwitchedOffAndOnIsNoBadWire) {
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

TEST_F(BusSuspicionsTest, WhatOthersKnowIsSaid) {
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

TEST_F(BusSuspicionsTest, WhoIsSilentForAMinuteIsNotTheBusiest) {
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

TEST_F(BusSuspicionsTest, WhereNobodyAcknowledgesItSaysSo) {
  known_.troubles.transmit = TransmitTrouble::not_acknowledged;
  be({.condition = BusCondition::passive, .transmit_errors = 128});
  for (int i = 0; i < 5; ++i) {
    error(0, CAN_ERR_ACK);
    loop_.advance(1s);
  }
  EXPECT_EQ(kind(), "alone");
  EXPECT_EQ(survey_.health().suspected_since, wall_now() - 2s);
}

TEST_F(BusSuspicionsTest, AnInterfaceThatComesBackIsLookedAtAnew) {
  traffic(2s);
  be({.condition = BusCondition::down});
  loop_.advance(20s);
  be({.condition = BusCondition::error_active});
  be({.condition = BusCondition::passive, .receive_errors = 135});
  loop_.advance(4s);
  EXPECT_EQ(kind(), "bit_rate") << "what was heard was before";
  EXPECT_THAT(told_.back(), HasSubstr("since the interface came up"));
}

TEST_F(BusSuspicionsTest, OfAnInterfaceThatWentDownNothingIsSuspected) {
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

}  // namespace
}  // namespace canopen
