#include "bridges/alarms/bus_findings.h"

#include <algorithm>
#include <iterator>

#include "bridges/alarms/reason.h"

namespace alarms {
namespace {

using config::Severity;

/// What is to be done first, by the likeliest cause.
std::string first_steps(canopen::BusCondition condition, const std::string& interface) {
  switch (condition) {
    case canopen::BusCondition::warning:
    case canopen::BusCondition::passive:
      return "check that all nodes have the same bit rate, the termination (120 ohm at both ends, 60 ohm between CAN_H "
             "and CAN_L), cable, shield and stubs";
    case canopen::BusCondition::bus_off:
      return "look for CAN_H and CAN_L swapped or short-circuited, and for a node with another bit rate; it comes back "
             "by restart-ms where that is set, else by `ip link set " +
             interface + " type can restart`";
    case canopen::BusCondition::down:
      return "check that the adapter is plugged in and its driver loaded (`ip -details link show " + interface +
             "`), then set its bit rate and `ip link set " + interface + " up`";
    case canopen::BusCondition::error_active:
      break;
  }
  return {};
}

BusFinding finding_of(const canopen::BusState& state, const std::string& interface) {
  return {bus_reason(state.condition),
          std::string(canopen::describe(state.condition)) +
              ". What to do first: " + first_steps(state.condition, interface),
          severity_of(state.condition)};
}

BusFinding finding_of(canopen::TransmitTrouble trouble, const std::string& interface) {
  if (trouble == canopen::TransmitTrouble::not_acknowledged) {
    return {"no-acknowledge",
            "nobody acknowledges our frames. What to do first: check that another node is switched on and wired to "
            "this bus, and "
            "that it has the bit rate of " +
                interface + "; a node that is alone on its bus always gets this",
            Severity::warning};
  }
  return {"transmit-stuck",
          "frames of ours do not leave, the transmit buffer stays full. What to do first: look for a bus full of "
          "frames with lower "
          "identifiers or another program that floods it (`candump " +
              interface + "`), else for an adapter that hangs (`ip -details -statistics link show " + interface +
              "`); with all motors stopped, taking " + interface +
              " down and up empties it: every drive of the bus is lost meanwhile",
          Severity::warning};
}

BusFinding finding_of(const DoubledNode& doubled) {
  return {doubled.proof ? "doubled-node-id" : "doubled-node-id-suspected",
          "node id " + std::to_string(doubled.node) + " of " + doubled.drive +
              (doubled.proof ? " is used twice: " : " may be used twice: ") + doubled.text,
          doubled.proof ? Severity::fault : Severity::warning};
}

}  // namespace

std::vector<BusFinding> bus_findings(const BusView& view) {
  std::vector<BusFinding> findings;
  // A controller alone on its bus is error-passive by that: the cause stands before what follows of it.
  const bool alone = view.troubles.transmit == canopen::TransmitTrouble::not_acknowledged;
  if (alone) {
    findings.push_back(finding_of(view.troubles.transmit, view.interface));
  }
  if (view.state.condition != canopen::BusCondition::error_active) {
    findings.push_back(finding_of(view.state, view.interface));
  }
  if (!alone && view.troubles.transmit != canopen::TransmitTrouble::none) {
    findings.push_back(finding_of(view.troubles.transmit, view.interface));
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
