#include "daemon/event_log.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "bridges/process/plant_change.h"

namespace gateway {

EventLog::EventLog(const boost::asio::any_io_executor& executor, const process::Plant& plant)
    : told_(plant.model().drives.size()),
      alarms_(executor, plant,
              [](spdlog::level::level_enum level, const std::string& line) { spdlog::log(level, "{}", line); }),
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
  if (told.online == status.online && told.nmt == status.nmt_now()) {
    return;
  }
  told = {status.online, status.nmt_now()};
  spdlog::info("{}: {}, {}", drive.model().name, status.online ? "online" : "offline",
               canopen::name_of(status.nmt_now()));
}

void EventLog::on_alarm(const process::Drive& drive, alarms::AlarmKind kind) {
  alarms_.on_alarm(drive, kind);
}

void EventLog::on_remark(const process::Drive& drive, const std::string& text) {
  spdlog::info("{}: {}", drive.model().name, text);
}

void EventLog::on_command_done(const process::Drive& /*drive*/, const process::CommandRecord& record,
                               const process::Outcome& outcome) {
  commands_.on_done(record, outcome, canopen::Clock::now());
}

void EventLog::on_plant_change(const process::PlantChange& change) {
  told_ = process::realigned(std::move(told_), change.drives, [](std::size_t) { return Told{}; });
  alarms_.on_plant_change(change);
}

void EventLog::on_bus(std::size_t bus) {
  alarms_.on_bus(bus);
}

void EventLog::on_bus_alarm(std::size_t bus) {
  alarms_.on_bus(bus);
}

}  // namespace gateway
