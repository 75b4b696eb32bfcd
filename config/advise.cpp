#include <algorithm>

#include "config/drive_draft.h"
#include "config/reader.h"
#include "config/text.h"

namespace config {
namespace {

bool takes_commands(const Drive& drive) {
  return drive.commands.writers.modbus || drive.commands.writers.mqtt || drive.commands.writers.local;
}

/// The drive notices by itself when commands stop coming: by our heartbeat, or by the time between RPDOs.
bool is_supervised(const Drive& drive) {
  const auto& rpdos = drive.node.rpdos;
  return drive.node.error_control.supervise_gateway != canopen::Duration::zero() ||
         std::any_of(rpdos.begin(), rpdos.end(),
                     [](const canopen::PdoSettings& rpdo) { return rpdo.event_timer.value_or(0) != 0; });
}

void advise_on_setpoints(DriveDraft& draft) {
  for (const SignalDraft& each : draft.signals) {
    const Signal& signal = each.signal;
    const bool setpoint = writable(signal.access) && signal.name != "control_command" && signal.values.empty() &&
                          signal.type != canopen::DataType::boolean;
    if (setpoint && !signal.max.has_value()) {
      draft.warning(draft.site.place, "set-point \"" + signal.name + "\" has no max; whatever its type holds may be " +
                                          "commanded. Write [drive.signals." + signal.name + "] max = …");
    }
  }
}

void advise_on_rpdos(DriveDraft& draft) {
  for (const canopen::PdoSettings& rpdo : draft.drive.node.rpdos) {
    for (const canopen::MappedObject& field : rpdo.mapping) {
      if (field.use == canopen::FieldUse::unnamed) {
        const std::string name = "rpdo" + std::to_string(rpdo.number);
        draft.warning(draft.site.place, name + " is never sent, because nothing says what its field " +
                                            canopen::to_string(field.object) +
                                            " is for; commands go by SDO. Name it, or declare it unused");
        break;
      }
    }
  }
}

/// A command waits for the drive's transfer that is on its way.
void advise_on_deadline(DriveDraft& draft) {
  const Duration deadline = draft.drive.commands.deadline;
  const Duration timeout = draft.drive.node.sdo.timeout;
  if (deadline > timeout) {
    return;
  }
  const Node* const commands = draft.site.find("commands");
  const bool stated = commands != nullptr && commands->find("deadline") != nullptr;
  draft.warning(
      stated ? place_of(*commands, "deadline") : draft.site.place,
      "commands.deadline (" + to_text(deadline) + ") is not longer than sdo.timeout (" + to_text(timeout) +
          "), so one read without an answer can use up a command's time; make one longer or the other shorter");
}

}  // namespace

void advise(DriveDraft& draft) {
  if (draft.site.find("on_stale") != nullptr && draft.drive.on_stale == OnStale::zero) {
    draft.warning(place_of(draft.site, "on_stale"), "on_stale = \"zero\" shows a lost drive as one that stands still");
  }
  if (!takes_commands(draft.drive)) {
    return;
  }
  if (!is_supervised(draft.drive)) {
    draft.warning(draft.site.place,
                  "takes commands, but nothing stops it when writer or gateway is gone; set supervise_gateway where "
                  "the drive can, and its own communication timeout where it cannot");
  }
  advise_on_deadline(draft);
  advise_on_setpoints(draft);
  advise_on_rpdos(draft);
}

}  // namespace config
