#include "config/drive_draft.h"
#include "config/load_site.h"
#include "config/reader.h"
#include "config/text.h"

namespace config {
namespace {

using canopen::Duration;

constexpr std::uint8_t kLastNode = 127;

std::string in_quotes(Duration duration) {
  return std::string("\"").append(to_text(duration)).append("\"");
}

void read_unit(DriveDraft& draft) {
  const Node* const unit = draft.site.find("unit");
  if (unit == nullptr) {
    draft.drive.unit = draft.drive.node.node;
  } else if (const auto number = read_as<std::uint8_t>(draft.site, "unit"); number.has_value()) {
    draft.drive.unit = number;
  }
}

void read_commands(DriveDraft& draft) {
  const Node* const table = read_table(draft.site, "commands");
  if (table == nullptr) {
    return;
  }
  Commands& commands = draft.drive.commands;
  for (const Node* const writer : read_texts(*table, "writers")) {
    commands.writers.modbus |= writer->text == "modbus";
    commands.writers.mqtt |= writer->text == "mqtt";
    commands.writers.local |= writer->text == "local";
  }
  take(commands.raw, read_boolean(*table, "raw"));
  take(commands.nmt_while_running, read_boolean(*table, "nmt_while_running"));
  take(commands.deadline, read_duration(*table, "deadline"));
}

void read_heartbeat(DriveDraft& draft) {
  canopen::ErrorControlSettings& control = draft.drive.node.error_control;
  take(control.heartbeat, read_duration(draft.site, "heartbeat"));
  take(control.heartbeat_timeout, read_duration(draft.site, "heartbeat_timeout"));
  take(control.supervise_gateway, read_duration(draft.site, "supervise_gateway"));
  if (control.heartbeat_timeout <= control.heartbeat) {
    const auto* const key = draft.site.find("heartbeat_timeout") != nullptr ? "heartbeat_timeout" : "heartbeat";
    draft.error(place_of(draft.site, key), "heartbeat_timeout " + in_quotes(control.heartbeat_timeout) +
                                               " must be longer than heartbeat " + in_quotes(control.heartbeat) +
                                               "; three times it is usual");
  }
  for (const auto* const key : {"heartbeat", "supervise_gateway"}) {
    const auto duration = read_duration(draft.site, key);
    if (duration.has_value() && !whole_milliseconds(*duration)) {
      draft.error(place_of(draft.site, key), std::string(key) + " must be whole milliseconds");
    }
  }
}

void check_supervision(DriveDraft& draft) {
  const Duration limit = draft.drive.node.error_control.supervise_gateway;
  if (limit == Duration::zero()) {
    return;
  }
  const Place place = place_of(draft.site, "supervise_gateway");
  const std::string bus = "bus \"" + draft.bus.name + "\"";
  if (draft.bus.node_id == 0) {
    draft.error(place, "supervise_gateway needs a gateway with a node id; set node_id of " + bus);
  } else if (draft.bus.heartbeat == Duration::zero()) {
    draft.error(place, "supervise_gateway needs the gateway's heartbeat; set heartbeat of " + bus);
  } else if (limit <= draft.bus.heartbeat) {
    draft.error(place, "supervise_gateway " + in_quotes(limit) + " must be longer than the heartbeat " +
                           in_quotes(draft.bus.heartbeat) + " of " + bus);
  }
}

}  // namespace

void read_own_keys(DriveDraft& draft) {
  Drive& drive = draft.drive;
  drive.name = read_text(draft.site, "name").value_or("");
  drive.profile = read_text(draft.site, "profile").value_or("");
  // An id out of range has its finding; 0 keeps it out of what is worked out from it.
  const auto node = read_as<std::uint8_t>(draft.site, "node").value_or(0);
  drive.node.node = node <= kLastNode ? node : std::uint8_t{0};
  drive.node.gateway_node = draft.bus.node_id;
  take(drive.node.reconfigure_running, read_boolean(draft.site, "reconfigure_running"));
  drive.on_stale = read_on_stale(draft.site, drive.on_stale);
  read_unit(draft);
  read_commands(draft);
  read_heartbeat(draft);
  check_supervision(draft);
}

}  // namespace config
