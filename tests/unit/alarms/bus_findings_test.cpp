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

TEST(BusFindings, ABusThatIsDownComesFirst) {
  EXPECT_EQ(reasons({.state = {.condition = BusCondition::down},
                     .troubles = {.own_node_id = true, .overload = false, .second_master = {}}}),
            (std::vector<std::string>{"down", "own-node-id"}));
  EXPECT_EQ(reasons({.state = {.condition = BusCondition::bus_off}}), (std::vector<std::string>{"bus-off"}));
}

}  // namespace
}  // namespace alarms
