#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/bus/bus_state.h"
#include "config/model.h"

namespace alarms {

/// A drive beside which another node seems to use its node id.
struct DoubledNode {
  std::string drive;
  std::uint8_t node = 0;
  bool proof = false;  ///< Else there are hints only.
  std::string text;    ///< By what it is known.
};

/// All that is known of a bus.
struct BusView {
  canopen::BusState state{};
  std::string interface{};       ///< For the text.
  std::uint8_t own_node_id = 0;  ///< The gateway's, for the text.
  canopen::BusTroubles troubles{};
  std::vector<DoubledNode> doubled{};
  bool other_gateway = false;  ///< Another gateway of our name is at the MQTT broker.
};

struct BusFinding {
  std::string_view reason;  ///< Of the closed list in docs/ALARMS.md.
  std::string text;
  config::Severity severity{};
};

/// What the alarm of a bus is about, faults first; none: no alarm.
[[nodiscard]] std::vector<BusFinding> bus_findings(const BusView& view);

}  // namespace alarms
