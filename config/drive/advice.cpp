#include <algorithm>

#include "config/drive/builder.h"
#include "config/site/endpoint.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

using canopen::Duration;

/// No client of write_from can reach one of the addresses to listen on.
bool nobody_can_write(const Modbus& modbus) {
  return std::none_of(modbus.write_from.begin(), modbus.write_from.end(), [&modbus](const Network& from) {
    return std::any_of(modbus.read_from.begin(), modbus.read_from.end(),
                       [&from](const Network& read) { return meet(read, from); }) &&
           std::any_of(modbus.listen.begin(), modbus.listen.end(),
                       [&from](const Endpoint& listen) { return can_arrive(from, listen); });
  });
}

/// Why nobody that `writers` names can command the drive in one of their ways; empty where he can.
std::string way_is_off(const DriveDraft& draft, std::string_view way) {
  if (way == "mqtt") {
    return draft.model.mqtt.has_value() ? "" : "there is no [mqtt]";
  }
  if (way == "local") {
    return draft.model.gateway.control.empty() ? "gateway.control is empty" : "";
  }
  if (!draft.model.modbus.has_value()) {
    return "there is no [modbus]";
  }
  if (!draft.drive.unit.has_value() && !draft.drive.flat.has_value()) {
    return "the drive has unit = \"none\"";
  }
  if (draft.model.modbus->write_from.empty()) {
    return "modbus.write_from is empty";
  }
  return nobody_can_write(*draft.model.modbus) ? "no client of modbus.write_from can connect (read_from, listen)" : "";
}

void advise_on_writers(const DriveDraft& draft) {
  const Node* const commands = read_table(draft.site, "commands");
  for (const Node* const writer : commands == nullptr ? std::vector<const Node*>() : read_texts(*commands, "writers")) {
    if (const std::string reason = way_is_off(draft, writer->text); !reason.empty()) {
      draft.warning(writer->place, "commands.writers names " + writer->text + ", but " + reason +
                                       ", so nobody can command the drive that way");
    }
  }
}

/// The first field of an RPDO with that use; null where there is none.
const canopen::MappedObject* field_with(const canopen::PdoSettings& rpdo, canopen::FieldUse use) {
  const auto found =
      std::find_if(rpdo.mapping.begin(), rpdo.mapping.end(), [use](const auto& field) { return field.use == use; });
  return found == rpdo.mapping.end() ? nullptr : &*found;
}

bool supervises_gateway(const DriveDraft& draft) {
  return draft.drive.node.error_control.supervise_gateway != Duration::zero();
}

/// The drive stops by itself when commands stop coming: without our heartbeat, where that is established, or by the
/// time between RPDOs where the profile says that it has that timer. Or the gateway does something when the writer is
/// gone.
bool is_supervised(const DriveDraft& draft) {
  const Commands& commands = draft.drive.commands;
  return (supervises_gateway(draft) && !draft.said.error_control.unconfirmed) || supervised_rpdo(draft).has_value() ||
         (commands.timeout != Duration::zero() && commands.on_timeout != OnTimeout::hold);
}

void advise_on_supervision(const DriveDraft& draft) {
  if (is_supervised(draft)) {
    return;
  }
  std::string text =
      supervises_gateway(draft)
          ? "takes commands, and supervises the gateway, but it is not established that its motor stops when the "
            "gateway is gone; try it slowly and uncoupled, then write unconfirmed = false in [drive.error_control]"
          : "takes commands, but nothing stops it when writer or gateway is gone; set supervise_gateway where the "
            "drive can, and its own communication timeout where it cannot";
  text += "; commands.timeout with on_timeout watches the writer";
  for (const PdoDraft& rpdo : draft.rpdos) {
    if (rpdo.settings.event_timer.value_or(0) != 0 && !rpdo.said->keys.supervised) {
      text += ". The event_timer of " + rpdo.said->name + " counts only with " + rpdo.said->name +
              ".supervised = true: say so where the drive is known to have that timer";
    }
  }
  draft.warning(draft.site.place, text);
}

/// A stop goes before everything else only where it is known to be one.
void advise_on_stops(const DriveDraft& draft) {
  const canopen::MotorSigns& motor = draft.drive.node.motor;
  const auto control = draft.drive.find("control_command");
  if (!control.has_value() || !writable(draft.drive.signals[*control].access)) {
    return;
  }
  if (motor.stops.empty()) {
    draft.warning(
        draft.site.place,
        "takes commands, but no value of control_command is known that only stops, so a stop waits like any "
        "command and a stop for all leaves the drive out; write [drive.signals.control_command] stop = […], or "
        "use a preset that has it");
  } else if (!canopen::first_stop(motor).has_value()) {
    draft.warning(draft.site.place,
                  "a stop for all leaves the drive out, because stop_masks name no exact value; write "
                  "[drive.signals.control_command] stop = […]");
  }
}

/// A drive that takes its control command in an RPDO alone can be stopped by one register only where what stands beside
/// it is known, or can be read.
void advise_on_single_stops(const DriveDraft& draft) {
  const auto control = draft.drive.find("control_command");
  if (!control.has_value() || !draft.drive.signals[*control].pdo_only ||
      draft.drive.signals[*control].source.kind != SourceKind::rpdo ||  // an error of its own
      !is_sent(draft, draft.drive.signals[*control].source.number)) {   // advise_on_rpdos() says worse
    return;
  }
  const std::string rpdo = to_text(draft.drive.signals[*control].source);
  std::string beside;
  for (const Signal& signal : draft.drive.signals) {
    if (signal.name != "control_command" && !signal.derived && signal.source == draft.drive.signals[*control].source) {
      beside += (beside.empty() ? "" : ", ") + signal.name;
    }
  }
  if (!beside.empty()) {
    draft.warning(in_the_site(place_of(*draft.signals[*control].said, "pdo_only"), draft.site.place),
                  "takes control_command in " + rpdo + " alone, beside " + beside +
                      ", so a stop that is written by itself, and a stop for all, may not reach it: after a start of "
                      "the gateway or of the drive only where the drive lets the others be read. One request that "
                      "writes all of them stops it (Modbus function 16, or set). Where nobody commands the others, "
                      "list them in " +
                      rpdo + ".unused");
  }
}

void advise_on_setpoints(const DriveDraft& draft) {
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

/// The signals that the drive takes in this RPDO alone; empty: none.
std::string pdo_only_signals(const DriveDraft& draft, const Source& source) {
  std::string names;
  for (const Signal& signal : draft.drive.signals) {
    if (signal.pdo_only && signal.source == source) {
      names += (names.empty() ? "" : ", ") + signal.name;
    }
  }
  return names;
}

void advise_on_rpdos(const DriveDraft& draft) {
  for (const canopen::PdoSettings& rpdo : draft.drive.node.rpdos) {
    const auto* const unnamed = field_with(rpdo, canopen::FieldUse::unnamed);
    if (unnamed == nullptr) {
      continue;
    }
    const std::string name = "rpdo" + std::to_string(rpdo.number);
    const std::string lost = pdo_only_signals(draft, {SourceKind::rpdo, rpdo.number});
    std::string text = name;
    text.append(" is never sent, because nothing says what its field ").append(canopen::to_string(unnamed->object));
    text.append(lost.empty() ? " is for; commands go by SDO"
                             : " is for; what is pdo_only there cannot be commanded at all: ");
    text.append(lost).append(". Make a signal of it, or list it in ").append(name).append(".unused");
    draft.warning(draft.site.place, text);
  }
}

/// A command waits for the drive's transfer that is on its way. The two defaults are known to leave it time enough.
void advise_on_deadline(const DriveDraft& draft) {
  const Duration deadline = draft.drive.commands.deadline;
  const Duration timeout = draft.drive.node.sdo.timeout;
  const Node* const commands = read_table(draft.site, "commands");
  const Node* const sdo = read_table(draft.merged, "sdo");
  const bool stated = (commands != nullptr && commands->find("deadline") != nullptr) ||
                      (sdo != nullptr && sdo->find("timeout") != nullptr);
  if (deadline >= 2 * timeout || !stated) {
    return;
  }
  draft.warning(command_place(draft, "deadline"),
                "commands.deadline (" + to_text(deadline) + ") is below twice sdo.timeout (" + to_text(timeout) +
                    "), so one read without an answer can use up a command's time; make one longer or the other "
                    "shorter");
}

/// A drive that only answers shows by that alone that it lives: CANOPEN.md, error control.
void advise_on_answers(const DriveDraft& draft) {
  const canopen::ErrorControlSettings& control = draft.drive.node.error_control;
  const Duration timeout = draft.drive.node.sdo.timeout;
  if (kind_of(control) != canopen::ErrorControlKind::none || control.heartbeat_timeout >= 3 * timeout) {
    return;
  }
  const std::string key = draft.site.find("heartbeat_timeout") != nullptr ? "heartbeat_timeout" : "heartbeat";
  draft.warning(place_of(draft.site, key), "heartbeat_timeout (" + to_text(control.heartbeat_timeout) +
                                               ") is below three times sdo.timeout (" + to_text(timeout) +
                                               "), so one or two missing answers are a loss of this drive without "
                                               "heartbeat and guarding; make one longer or the other shorter");
}

/// What the profile does not know for sure, in one line.
void advise_on_unconfirmed(const DriveDraft& draft) {
  std::string names;
  const auto add = [&names](const std::string& name) { names += (names.empty() ? "" : ", ") + name; };
  for (const auto* const pdos : {&draft.tpdos, &draft.rpdos}) {
    for (const PdoDraft& pdo : *pdos) {
      const auto& used = pdos == &draft.tpdos ? draft.drive.node.tpdos : draft.drive.node.rpdos;
      if (pdo.said->keys.unconfirmed && std::any_of(used.begin(), used.end(), [&pdo](const auto& each) {
            return each.number == pdo.settings.number;
          })) {
        add(pdo.said->name);
      }
    }
  }
  for (const SignalDraft& signal : draft.signals) {
    if (signal.said->keys.signal.unconfirmed && !draft.told_unconfirmed.contains(signal.said->name)) {
      add(signal.said->name);
    }
  }
  if (!names.empty()) {
    draft.warning(draft.site.place, "not established for this drive: " + names +
                                        ". Compare them with what it shows itself, then write unconfirmed = false in "
                                        "[drive.signals.NAME] or [drive.tpdoN]");
  }
}

/// The stop values are those of a preset that is unconfirmed, and the site says none itself.
bool stops_are_unconfirmed(const DriveDraft& draft) {
  const auto control = draft.drive.find("control_command");
  if (!control.has_value() || !draft.told_unconfirmed.contains("control_command")) {
    return false;
  }
  const auto& keys = draft.signals[*control].said->table->entries;
  return std::none_of(keys.begin(), keys.end(), [](const Entry& entry) {
    return (entry.key == "stop" || entry.key == "stop_masks") && entry.value.place.file == 0;
  });
}

/// Before a drive is sent pre-operational or started again, its motor and its last command are looked at.
void advise_on_motor(const DriveDraft& draft) {
  const canopen::NodeSettings& node = draft.drive.node;
  if (node.self_starting && !node.motor.running.has_value()) {
    draft.warning(in_the_site(place_of(draft.merged, "self_starting"), draft.site.place),
                  "self_starting has no effect without a signal \"running\": the drive is sent pre-operational only "
                  "where that reads false; add the signal, or leave self_starting out");
  }
  if (!node.restart) {
    return;
  }
  std::string unknown;
  const auto need = [&unknown](bool known, std::string_view what) {
    unknown += known ? "" : (unknown.empty() ? "" : ", ") + std::string(what);
  };
  need(node.motor.running.has_value(), "running");
  need(node.motor.fault.has_value(), "fault");
  const bool control = node.motor.control.has_value();
  need(control, "control_command");
  need(!control || !node.motor.stops.empty(), "stop values of control_command");
  need(!stops_are_unconfirmed(draft), "confirmed stop values of control_command");
  if (!unknown.empty()) {
    draft.warning(place_of(draft.site, "restart"),
                  "restart may let the drive resume its last command, because these are "
                  "not known: " +
                      unknown + ". Write it under [drive.signals], or leave restart out");
  }
}

}  // namespace

bool is_sent(const DriveDraft& draft, std::uint16_t number) {
  const auto& rpdos = draft.drive.node.rpdos;
  return std::any_of(rpdos.begin(), rpdos.end(), [number](const canopen::PdoSettings& rpdo) {
    return rpdo.number == number && field_with(rpdo, canopen::FieldUse::commanded) != nullptr &&
           field_with(rpdo, canopen::FieldUse::unnamed) == nullptr;
  });
}

std::optional<std::uint16_t> supervised_rpdo(const DriveDraft& draft) {
  const auto found = std::find_if(draft.rpdos.begin(), draft.rpdos.end(), [&draft](const PdoDraft& rpdo) {
    return rpdo.said->keys.supervised && rpdo.settings.event_timer.value_or(0) != 0 &&
           is_sent(draft, rpdo.settings.number);
  });
  return found == draft.rpdos.end() ? std::nullopt : std::optional(found->settings.number);
}

void advise(DriveDraft& draft) {
  if (draft.keys.on_stale == OnStale::zero) {
    draft.warning(place_of(draft.site, "on_stale"), "on_stale = \"zero\" shows a lost drive as one that stands still");
  }
  advise_on_unconfirmed(draft);
  advise_on_motor(draft);
  advise_on_answers(draft);
  if (!draft.drive.commands.writers.any()) {
    return;
  }
  advise_on_writers(draft);
  advise_on_supervision(draft);
  advise_on_stops(draft);
  advise_on_single_stops(draft);
  advise_on_deadline(draft);
  advise_on_setpoints(draft);
  advise_on_rpdos(draft);
}

}  // namespace config
