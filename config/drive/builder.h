#pragma once

#include <initializer_list>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/drive/drive_keys.h"
#include "config/drive/profile.h"
#include "config/drive_notes.h"
#include "config/model.h"
#include "config/toml/document.h"
#include "config/toml/report.h"

// One drive while it is put together, and the steps in their order.

namespace config {

struct PdoDraft {
  const Said<PdoKeys>* said = nullptr;
  canopen::PdoSettings settings;
  std::vector<canopen::ObjectAddress> unused{};  ///< RPDO: fields that the site declares unused.
};

struct SignalDraft {
  const Said<SignalKeys>* said = nullptr;
  Signal signal;

  [[nodiscard]] bool derived() const noexcept { return said->keys.from.has_value(); }
};

struct DriveDraft {
  const Node& site;    ///< The `[[drive]]` table.
  const Model& model;  ///< What the site says beside its drives.
  Report& report;
  std::string where;  ///< Begins its findings: `drive "pump1"`.
  DriveKeys keys{};
  Bus bus{};           ///< Its bus, or one with defaults where that is not known.
  Node merged{};       ///< Profile, presets, assigned objects and site laid over each other.
  OverlayKeys said{};  ///< What stands there.
  Drive drive{};
  DriveNotes notes{};
  std::vector<PdoDraft> tpdos{};
  std::vector<PdoDraft> rpdos{};
  std::vector<SignalDraft> signals{};
  std::vector<canopen::ObjectAddress> unused{};  ///< Assigned objects that the site calls "unused".
  std::set<std::string> told_unconfirmed{};      ///< Signals of presets and slots whose warning says so already.

  void error(Place place, const std::string& text) const { report.error(place, where + ": " + text); }
  void warning(Place place, const std::string& text) const { report.warning(place, where + ": " + text); }
};

/// Where a key of a table stands; the table's name where it has none. Where that is a profile, and the site's file says
/// one of `others` in this table, it stands there: what the site wrote does not fit the profile.
template <class S>
[[nodiscard]] Place place_of(const Said<S>& said, std::string_view key,
                             std::initializer_list<std::string_view> others = {}) {
  const Node* const value = said.table->find(key);
  Place place = value == nullptr ? said.place : value->place;
  for (const std::string_view other : others) {
    if (const Node* const beside = said.table->find(other); beside != nullptr) {
      place = in_the_site(place, beside->place);
    }
  }
  return place;
}

/// Where a key of `[drive.commands]` stands; the drive where it is left out.
[[nodiscard]] Place command_place(const DriveDraft& draft, std::string_view key);

/// An RPDO of that number is really sent, and so armed and repeated: of those in use, each field of it known and one
/// commanded.
[[nodiscard]] bool is_sent(const DriveDraft& draft, std::uint16_t number);
/// An RPDO that is sent and has an event timer, which the profile says that the drive has; nothing: none.
[[nodiscard]] std::optional<std::uint16_t> supervised_rpdo(const DriveDraft& draft);

struct BuiltDrive {
  Drive drive;
  DriveNotes notes;
};

/// Puts one drive together; what is wrong with it goes to the report. `number` names it where it has no name.
[[nodiscard]] BuiltDrive build_drive(const Node& site, std::size_t number, const Model& model, ProfileLibrary& library,
                                     Report& report);

// ---- The steps, in this order.

/// Name, node, unit, commands and times: what only the site says.
void take_own_keys(DriveDraft& draft);
/// Lays presets, assigned objects and the site over the profile.
void compose(DriveDraft& draft, const Profile& profile);
/// Heartbeat, SDO, EMCY, identity, setup objects and fault texts.
void take_node_settings(DriveDraft& draft);
/// What people are told of it.
void take_notes(DriveDraft& draft);
/// PDO communication and mapping.
void take_pdos(DriveDraft& draft);
/// Signals by themselves.
void take_signals(DriveDraft& draft);
/// Where each signal's value comes from; settles who fills the fields of RPDOs, and drops PDOs that serve no signal.
void connect_pdos(DriveDraft& draft);
/// Modbus addresses: fixed ones, ranges, overlaps.
void place_signals(DriveDraft& draft);
/// Moves the signals into the drive in the order of their addresses, words before what is derived from them; finds
/// those that tell of faults and of the motor.
void order_signals(DriveDraft& draft);
/// What a timeout does, and whether it and `feedback` can do it.
void take_commands(DriveDraft& draft);
/// What is allowed but should be thought about.
void advise(DriveDraft& draft);

}  // namespace config
