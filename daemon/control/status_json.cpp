#include "daemon/control/status_json.h"

#include <fmt/format.h>

#include <chrono>
#include <optional>
#include <ranges>
#include <string_view>

#include "bridges/mqtt/payload.h"
#include "bridges/mqtt/value_text.h"
#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"
#include "daemon/bus_report.h"

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

void append_values(std::string& out, const process::Drive& drive, canopen::TimePoint now) {
  const config::Drive& model = drive.model();
  ObjectText object(out);
  for (std::size_t i = 0; i < model.signals.size(); ++i) {
    const auto id = static_cast<process::SignalId>(i);
    if (config::readable(model.signals[i].access)) {
      const auto raw = drive.image().fresh(id, now) ? std::optional(drive.image().raw(id)) : std::nullopt;
      mqtt::append_member(object, model.signals[i], mqtt::shape_of(model, id), raw);
    }
  }
  object.close();
}

// What was commanded and still counts: an RPDO would carry it along.
void append_commanded(std::string& out, const process::Drive& drive) {
  const config::Drive& model = drive.model();
  ObjectText object(out);
  for (std::size_t i = 0; i < model.signals.size(); ++i) {
    const auto id = static_cast<process::SignalId>(i);
    if (const auto known = drive.commanded().known(id)) {
      mqtt::append_member(object, model.signals[i], mqtt::shape_of(model, id), known);
    }
  }
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
  if (!alarm.record.empty()) {
    object.text("record", alarm.record);
  }
  object.close();
}

void append_alarms(std::string& out, const process::Drive& drive) {
  const auto active = [&drive](alarms::AlarmKind kind) { return drive.alarm(kind).known && drive.alarm(kind).active; };
  text::append_list(out, alarms::kAlarmKinds | std::views::filter(active), [&drive](std::string& to, auto kind) {
    append_alarm(to, alarms::name_of(kind), drive.alarm(kind));
  });
}

void append_bus(std::string& out, const process::Plant& plant, std::size_t index, const Surveys& surveys) {
  const config::Bus& bus = plant.model().buses[index];
  const canopen::BusState& state = plant.bus_state(index);
  ObjectText object(out);
  object.text("name", bus.name);
  object.text("interface", bus.interface);
  object.boolean("up", state.up());
  object.text("state", state_of(state.condition));
  if (const canopen::BusStatistics statistics = plant.bus_statistics(index); statistics.bitrate != 0) {
    object.key("load") += fmt::format("{:.1f}", statistics.load_per_mille / 10.0);
  } else {
    object.null("load");
  }
  append_bus_summary(object, plant, index, surveys);
  object.close();
}

}  // namespace

void append_drive_status(std::string& out, const process::Plant& plant, std::size_t index, canopen::TimePoint now,
                         Ages ages) {
  const process::Drive& drive = plant.drive(index);
  const canopen::NodeStatus& status = drive.status();
  ObjectText object(out);
  object.text("name", drive.model().name);
  object.text("bus", plant.model().buses[drive.bus()].name);
  object.integer("node", drive.model().node.node);
  object.text("profile", drive.model().profile);
  object.boolean("enabled", drive.model().enabled);
  object.boolean("online", status.online);
  object.text("nmt", canopen::name_of(status.nmt_now()));
  object.text("boot", boot_of(status.boot_result));
  object.text("boot_text", status.boot_text);
  if (!drive.pending_change().empty()) {
    object.text("reload", drive.pending_change());
  }
  if (status.last_heartbeat && ages == Ages::shown) {
    object.key("heartbeat_age") += seconds(now - *status.last_heartbeat);
  } else {
    object.null("heartbeat_age");
  }
  object.boolean("fresh", drive.image().all_fresh(now));
  append_values(object.key("values"), drive, now);
  append_commanded(object.key("commanded"), drive);
  object.key("control") += mqtt::control_json(drive.control());
  append_alarms(object.key("alarms"), drive);
  object.close();
}

std::string status_head(const process::Plant& plant, canopen::TimePoint started, canopen::TimePoint now,
                        const Surveys& surveys) {
  std::string out;
  ObjectText object(out);
  object.text("ts", text::timestamp(canopen::wall_now()));
  object.text("gateway", plant.model().gateway.name);
  object.text("version", GATEWAY_VERSION);
  object.key("uptime") += seconds(now - started);
  text::append_list(object.key("buses"), std::views::iota(std::size_t{0}, plant.model().buses.size()),
                    [&](std::string& to, std::size_t i) { append_bus(to, plant, i, surveys); });
  object.key("drives") += '[';
  return out;
}

std::string status_json(const process::Plant& plant, canopen::TimePoint started, canopen::TimePoint now,
                        const Surveys& surveys) {
  std::string out = status_head(plant, started, now, surveys);
  for (std::size_t i = 0; i < plant.size(); ++i) {
    out += i == 0 ? "" : ",";
    append_drive_status(out, plant, i, now);
  }
  return out + "]}";
}

}  // namespace gateway::control
