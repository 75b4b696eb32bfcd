#pragma once

#include <string>
#include <vector>

#include "config/model.h"

namespace gateway {

/// A drive that is not yet as it is wanted.
struct WaitingDrive {
  std::string name;
  bool in_use = false;  ///< With its old section, which is another one or not wanted any more; else it is new.
  bool turns = false;   ///< It waits for its own standstill; else for that of others.
  friend bool operator==(const WaitingDrive&, const WaitingDrive&) = default;
};

/// What is to be used now of a configuration that is wanted.
struct EffectiveModel {
  config::Model model;
  std::vector<WaitingDrive> waiting;  ///< Empty: `model` is what is wanted.
};

/// The wanted configuration, but for drives whose section changed or went while their motor turns: those keep the old
/// one, and so does their bus with all that is on it. What is wanted and cannot be beside that waits, too: a drive with
/// the name, the node id, a COB-ID, the Modbus unit or addresses on the flat unit of one that stays, a bus on its
/// interface, a [modbus] whose flat unit is its unit. `turns`: of each drive in use.
[[nodiscard]] EffectiveModel effective_model(const config::Model& in_use, const config::Model& wanted,
                                             const std::vector<bool>& turns);

}  // namespace gateway
