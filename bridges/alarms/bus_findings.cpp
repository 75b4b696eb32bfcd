#include "bridges/alarms/bus_findings.h"

#include <algorithm>
#include <iterator>

#include "bridges/alarms/reason.h"

namespace alarms {
namespace {

using config::Severity;

BusFinding finding_of(const DoubledNode& doubled) {
  return {doubled.proof ? "doubled-node-id" : "doubled-node-id-suspected",
          "node id " + std::to_string(doubled.node) + " of " + doubled.drive +
              (doubled.proof ? " is used twice: " : " may be used twice: ") + doubled.text,
          doubled.proof ? Severity::fault : Severity::warning};
}

}  // namespace

std::vector<BusFinding> bus_findings(const BusView& view) {
  std::vector<BusFinding> findings;
  if (view.state.condition != canopen::BusCondition::error_active) {
    findings.push_back({bus_reason(view.state.condition), std::string(canopen::describe(view.state.condition)),
                        severity_of(view.state.condition)});
  }
  for (const DoubledNode& doubled : view.doubled) {
    findings.push_back(finding_of(doubled));
  }
  if (view.troubles.own_node_id) {
    findings.push_back({"own-node-id",
                        "another node sends heartbeats with the gateway's node id " + std::to_string(view.own_node_id) +
                            ": give one of them another (`node_id` of the bus)",
                        Severity::fault});
  }
  if (view.troubles.overload) {
    findings.push_back({"overload",
                        "load above 90 %: values, heartbeats and commands come late; lengthen the periods of TPDOs and "
                        "polls, or raise the bit rate",
                        Severity::warning});
  }
  if (!view.troubles.second_master.empty()) {
    findings.push_back({"second-master", view.troubles.second_master, Severity::warning});
  }
  if (view.other_gateway) {
    findings.push_back({"other-gateway", "another gateway of this name lives at the MQTT broker", Severity::warning});
  }
  std::vector<BusFinding> in_order;
  for (const Severity severity : {Severity::fault, Severity::warning}) {
    std::copy_if(findings.begin(), findings.end(), std::back_inserter(in_order),
                 [severity](const BusFinding& finding) { return finding.severity == severity; });
  }
  return in_order;
}

}  // namespace alarms
