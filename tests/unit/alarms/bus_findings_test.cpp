#include "bridges/alarms/bus_findings.h"

#include <gtest/gtest.h>

namespace alarms {
namespace {

using canopen::BusCondition;
using config::Severity;

std::vector<std::string> reasons(const BusView& view) {
  std::vector<std::string> reasons;
  for (const BusFinding& finding : bus_findings(view)) {
    reasons.emplace_back(finding.reason);
  }
  return reasons;
}

TEST(BusFindings, NothingOnAGoodBus) {
  EXPECT_TRUE(bus_findings({.state = {.condition = BusCondition::error_active}}).empty());
}

TEST(BusFindings, OneForEachFaultsFirst) {
  const BusView view{
      .state = {.condition = BusCondition::passive},
      .own_node_id = 127,
      .troubles = {.own_node_id = true, .overload = true, .second_master = "it sends NMT commands"},
      .doubled = {{.drive = "pump1", .node = 5, .proof = false, .text = "heartbeats come twice as often"},
                  {.drive = "pump2", .node = 6, .proof = true, .text = "two boot-ups within one period"}},
      .other_gateway = true};
  EXPECT_EQ(reasons(view),
            (std::vector<std::string>{"doubled-node-id", "own-node-id", "passive", "doubled-node-id-suspected",
                                      "overload", "second-master", "other-gateway"}));
  const std::vector<BusFinding> findings = bus_findings(view);
  EXPECT_EQ(findings[0].text, "node id 6 of pump2 is used twice: two boot-ups within one period");
  EXPECT_EQ(findings[0].severity, Severity::fault);
  EXPECT_NE(findings[1].text.find("127"), std::string::npos);
  EXPECT_EQ(findings[3].text, "node id 5 of pump1 may be used twice: heartbeats come twice as often");
  EXPECT_EQ(findings[3].severity, Severity::warning);
}

// Whoever reads it at the plant knows what to do.
TEST(BusFindings, EachNamesItsLikelyCauseAndTheRemedy) {
  struct Told {
    BusView view;
    std::string_view reason;
    std::vector<std::string_view> said;
  };
  const auto in = [](BusCondition condition) {
    return BusView{.state = {.condition = condition}, .interface = "can7"};
  };
  const auto with = [&in](canopen::TransmitTrouble trouble) {
    BusView view = in(BusCondition::error_active);
    view.troubles.transmit = trouble;
    return view;
  };
  const std::vector<Told> cases{
      {in(BusCondition::warning), "warning", {"error-warning", "bit rate", "termination", "cable"}},
      {in(BusCondition::passive), "passive", {"error-passive", "bit rate", "termination", "cable"}},
      {in(BusCondition::bus_off), "bus-off", {"short-circuited", "bit rate", "ip link set can7 type can restart"}},
      {in(BusCondition::down), "down", {"adapter", "ip link set can7 up"}},
      {with(canopen::TransmitTrouble::not_acknowledged),
       "no-acknowledge",
       {"nobody acknowledges", "another node is switched on", "bit rate of can7"}},
      {with(canopen::TransmitTrouble::stuck),
       "transmit-stuck",
       {"transmit buffer stays full", "candump can7", "adapter that hangs"}}};
  for (const Told& one : cases) {
    const std::vector<BusFinding> findings = bus_findings(one.view);
    ASSERT_EQ(findings.size(), 1U) << one.reason;
    EXPECT_EQ(findings[0].reason, one.reason);
    EXPECT_NE(findings[0].text.find(". What to do first: "), std::string::npos) << findings[0].text;
    for (const std::string_view said : one.said) {
      EXPECT_NE(findings[0].text.find(said), std::string::npos) << said << " in " << findings[0].text;
    }
  }
  EXPECT_EQ(bus_findings(cases[4].view)[0].severity, Severity::warning);
  EXPECT_EQ(bus_findings(cases[5].view)[0].severity, Severity::warning);
}

// Alone on its bus a controller is error-passive within milliseconds.
TEST(BusFindings, ThatNobodyAcknowledgesStandsBeforeTheStateThatFollowsOfIt) {
  for (const BusCondition condition : {BusCondition::warning, BusCondition::passive}) {
    BusView view{.state = {.condition = condition}};
    view.troubles.transmit = canopen::TransmitTrouble::not_acknowledged;
    EXPECT_EQ(reasons(view).at(0), "no-acknowledge");
    EXPECT_EQ(reasons(view).size(), 2U);
  }
  BusView stuck{.state = {.condition = BusCondition::passive}};
  stuck.troubles.transmit = canopen::TransmitTrouble::stuck;
  EXPECT_EQ(reasons(stuck), (std::vector<std::string>{"passive", "transmit-stuck"}));
}

TEST(BusFindings, ABusThatIsDownComesFirst) {
  EXPECT_EQ(reasons({.state = {.condition = BusCondition::down},
                     .troubles = {.own_node_id = true, .overload = false, .second_master = {}}}),
            (std::vector<std::string>{"down", "own-node-id"}));
  EXPECT_EQ(reasons({.state = {.condition = BusCondition::bus_off}}), (std::vector<std::string>{"bus-off"}));
}

}  // namespace
}  // namespace alarms
