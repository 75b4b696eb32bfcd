#include "daemon/event_log.h"

#include <spdlog/spdlog.h>

namespace gateway {
namespace {

spdlog::level::level_enum level_of(const alarms::Alarm& alarm) noexcept {
  if (!alarm.active) {
    return spdlog::level::info;
  }
  return alarm.severity == config::Severity::fault ? spdlog::level::err : spdlog::level::warn;
}

spdlog::level::level_enum level_of(const canopen::BusState& state) noexcept {
  if (!state.up()) {
    return spdlog::level::err;
  }
  return state.condition == canopen::BusCondition::error_active ? spdlog::level::info : spdlog::level::warn;
}

}  // namespace

EventLog::EventLog(const process::Plant& plant)
    : plant_(plant),
      told_(plant.model().drives.size()),
      bus_told_(plant.model().buses.size()),
      commands_([](const std::string& line) { spdlog::info("{}", line); }) {}

void EventLog::on_values(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) {}

void EventLog::on_freshness(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) {}

void EventLog::on_commanded(const process::Drive& drive, std::span<const process::SignalId> signals) {
  for (const process::SignalId id : signals) {
    spdlog::debug("{}: {} commanded, raw {}", drive.model().name, drive.model().signals[id].name,
                  drive.commanded().shown(id));
  }
}

void EventLog::on_status(const process::Drive& drive) {
  const canopen::NodeStatus& status = drive.status();
  Told& told = told_[drive.index()];
  if (told.online == status.online && told.nmt == status.nmt) {
    return;
  }
  told = {status.online, status.nmt};
  spdlog::info("{}: {}, {}", drive.model().name, status.online ? "online" : "offline", canopen::name_of(status.nmt));
}

void EventLog::on_alarm(const process::Drive& drive, alarms::AlarmKind kind) {
  const alarms::Alarm& alarm = drive.alarm(kind);
  if (alarm.id.empty()) {
    return;
  }
  spdlog::log(level_of(alarm), "{}: alarm {} {}: 0x{:04X} {}", drive.model().name, alarms::name_of(kind),
              alarm.active ? (alarm.confirmed ? "active" : "active, not confirmed") : "over", alarm.code, alarm.text);
}

void EventLog::on_remark(const process::Drive& drive, const std::string& text) {
  spdlog::info("{}: {}", drive.model().name, text);
}

void EventLog::on_command_done(const process::Drive& /*drive*/, const process::CommandRecord& record,
                               const process::Outcome& outcome) {
  commands_.on_done(record, outcome, canopen::Clock::now());
}

void EventLog::on_bus(std::size_t bus) {
  const canopen::BusState& state = plant_.bus_state(bus);
  if (bus_told_[bus] == state.condition) {
    return;
  }
  bus_told_[bus] = state.condition;
  spdlog::log(level_of(state), "bus {}: {}", plant_.model().buses[bus].name, canopen::describe(state.condition));
}

}  // namespace gateway
