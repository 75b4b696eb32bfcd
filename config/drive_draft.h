#pragma once

#include <string>
#include <vector>

#include "config/document.h"
#include "config/model.h"
#include "config/profile.h"
#include "config/report.h"

// One drive while it is put together, and the steps in their order.

namespace config {

struct PdoDraft {
  canopen::PdoSettings settings;
  const Node* table = nullptr;
  std::string name;                              ///< `tpdo1`
  std::vector<canopen::ObjectAddress> unused{};  ///< RPDO: fields that the site declares unused.
};

struct SignalDraft {
  Signal signal;
  const Node* table = nullptr;
  Place place;       ///< Of its name.
  std::string from;  ///< A derived one: the signal whose word it reads.
};

struct DriveDraft {
  const Node& site;  ///< The `[[drive]]` table.
  Report& report;
  std::string where;  ///< Begins its findings: `drive "pump1"`.
  Bus bus{};          ///< Its bus, or one with defaults where that is not known.
  Node merged{};      ///< Profile, presets, assigned objects and site laid over each other.
  Drive drive{};
  std::vector<PdoDraft> tpdos{};
  std::vector<PdoDraft> rpdos{};
  std::vector<SignalDraft> signals{};
  std::vector<canopen::ObjectAddress> unused{};  ///< Assigned objects that the site calls "unused".

  void error(Place place, const std::string& text) const { report.error(place, where + ": " + text); }
  void warning(Place place, const std::string& text) const { report.warning(place, where + ": " + text); }
};

/// Name, node, unit, commands and times: what only the site says.
void read_own_keys(DriveDraft& draft);
/// Lays presets, assigned objects and the site over the profile.
void compose(DriveDraft& draft, const Profile& profile);
/// Heartbeat, SDO, EMCY, identity, setup objects and fault texts.
void read_node_settings(DriveDraft& draft);
/// PDO communication and mapping.
void read_pdos(DriveDraft& draft);
/// Signals, and what they need of the PDOs; ends with the signals in the order of their Modbus addresses.
void read_signals(DriveDraft& draft);
/// Where each signal's value comes from; settles who fills the fields of RPDOs, and drops PDOs that serve no signal.
void connect_pdos(DriveDraft& draft);
/// Modbus addresses: fixed ones, ranges, overlaps.
void place_signals(DriveDraft& draft);
/// Moves the signals into the drive, words before what is derived from them.
void finish_signals(DriveDraft& draft);
/// What is allowed but should be thought about.
void advise(DriveDraft& draft);

}  // namespace config
