#include "daemon/control/status_json.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <string_view>

#include "bridges/mqtt/value_text.h"
#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"

namespace gateway::control {
namespace {

using text::ObjectText;

std::string_view state_of(canopen::BusCondition condition) noexcept {
  switch (condition) {
    case canopen::BusCondition::error_active:
      return "error-active";
    case canopen::BusCondition::warning:
      return "error-warning";
    case canopen::BusCondition::passive:
      return "error-passive";
    case canopen::BusCondition::bus_off:
      return "bus-off";
    case canopen::BusCondition::down:
      break;
  }
  return "down";
}

std::string seconds(canopen::Duration time) {
  return fmt::format("{:.1f}", std::chrono::duration<double>(time).count());
}

std::string boot_of(canopen::BootResult result) {
  if (canopen::is_letter(result)) {
    return {static_cast<char>(result)};
  }
  return result == canopen::BootResult::ok ? "ok" : "not-booted";
}

// A value as its MQTT topic has it; a name is a string.
void append_signal(ObjectText& object, const config::Drive& drive, process::SignalId id, canopen::Raw raw) {
  const config::Signal& signal = drive.signals[id];
  const mqtt::Shape shape = mqtt::shape_of(drive, id);
  std::string text;
  if (!mqtt::append_value(text, signal, shape, raw)) {
    object.null(signal.name);
  } else if (shape == mqtt::Shape::name) {
    object.text(signal.name, text);
  } else {
    object.key(signal.name) += text;
  }
}

void append_values(std::string& out, const process::Drive& drive, canopen::TimePoint now) {
  const config::Drive& model = drive.model();
  ObjectText object(out);
  for (std::size_t i = 0; i < model.signals.size(); ++i) {
    const auto id = static_cast<process::SignalId>(i);
    if (!config::readable(model.signals[i].access)) {
      continue;
    }
    if (drive.image().fresh(id, now)) {
      append_signal(object, model, id, drive.image().raw(id));
    } else {
      object.null(model.signals[i].name);
    }
  }
  object.close();
}

// What was commanded and still counts: an RPDO would carry it along.
void append_commanded(std::string& out, const process::Drive& drive) {
  ObjectText object(out);
  for (std::size_t i = 0; i < drive.model().signals.size(); ++i) {
    const auto id = static_cast<process::SignalId>(i);
    if (const std::optional<canopen::Raw> known = drive.commanded().known(id)) {
      append_signal(object, drive.model(), id, *known);
    }
  }
  object.close();
}

void append_control(std::string& out, const process::ControlState& control) {
  ObjectText object(out);
  if (control.holder) {
    object.text("holder", to_string(*control.holder));
    object.text("since", text::timestamp(control.since));
  } else {
    object.null("holder");
    object.null("since");
  }
  object.boolean("timeout", control.timeout);
  object.close();
}

void append_alarm(std::string& out, std::string_view kind, const alarms::Alarm& alarm) {
  ObjectText object(out);
  object.text("kind", kind);
  object.text("code", fmt::format("0x{:04X}", alarm.code));
  object.text("reason", alarm.reason);
  object.text("text", alarm.text);
  object.text("severity", alarms::name_of(alarm.severity));
  object.text("since", text::timestamp(alarm.since));
  object.boolean("confirmed", alarm.confirmed);
  object.boolean("first", alarm.first);
  object.close();
}

void append_alarms(std::string& out, const process::Drive& drive) {
  out += '[';
  bool first = true;
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    if (const alarms::Alarm& alarm = drive.alarm(kind); alarm.known && alarm.active) {
      text::append_separator(out, first);
      append_alarm(out, alarms::name_of(kind), alarm);
    }
  }
  out += ']';
}

void append_bus(std::string& out, const process::Plant& plant, std::size_t index) {
  const config::Bus& bus = plant.model().buses[index];
  const canopen::BusState& state = plant.bus_state(index);
  ObjectText object(out);
  object.text("name", bus.name);
  object.text("interface", bus.interface);
  object.boolean("up", state.up());
  object.text("state", state_of(state.condition));
  if (bus.bitrate) {
    object.key("load") += fmt::format("{:.1f}", plant.bus_statistics(index).load_per_mille / 10.0);
  } else {
    object.null("load");
  }
  object.close();
}

void append_drive(std::string& out, const process::Plant& plant, std::size_t index, canopen::TimePoint now) {
  const process::Drive& drive = plant.drive(index);
  const canopen::NodeStatus& status = drive.status();
  ObjectText object(out);
  object.text("name", drive.model().name);
  object.text("bus", plant.model().buses[drive.model().bus].name);
  object.integer("node", drive.model().node.node);
  object.boolean("enabled", drive.model().enabled);
  object.boolean("online", status.online);
  object.text("nmt", canopen::name_of(status.nmt));
  object.text("boot", boot_of(status.boot_result));
  object.text("boot_text", status.boot_text);
  if (status.last_heartbeat) {
    object.key("heartbeat_age") += seconds(now - *status.last_heartbeat);
  } else {
    object.null("heartbeat_age");
  }
  object.boolean("fresh", drive.image().all_fresh(now));
  append_values(object.key("values"), drive, now);
  append_commanded(object.key("commanded"), drive);
  append_control(object.key("control"), drive.control());
  append_alarms(object.key("alarms"), drive);
  object.close();
}

}  // namespace

std::string status_json(const process::Plant& plant, canopen::TimePoint started, canopen::TimePoint now) {
  std::string out;
  ObjectText object(out);
  object.text("ts", text::timestamp(canopen::wall_now()));
  object.text("gateway", plant.model().gateway.name);
  object.text("version", GATEWAY_VERSION);
  object.key("uptime") += seconds(now - started);
  std::string& buses = object.key("buses") += '[';
  bool first = true;
  for (std::size_t i = 0; i < plant.model().buses.size(); ++i) {
    text::append_separator(buses, first);
    append_bus(buses, plant, i);
  }
  buses += ']';
  std::string& drives = object.key("drives") += '[';
  first = true;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    text::append_separator(drives, first);
    append_drive(drives, plant, i, now);
  }
  drives += ']';
  object.close();
  return out;
}

}  // namespace gateway::control
