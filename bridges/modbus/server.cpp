#include "bridges/modbus/server.h"

#include <utility>

namespace modbus {

Server::Server(const boost::asio::any_io_executor& executor, process::Plant& plant, const config::Modbus& settings,
               net::Notices notices)
    : settings_(settings), units_(plant, settings_), connections_(executor, settings_, units_, std::move(notices)) {}

void Server::count_lost_messages_by(std::function<std::uint64_t()> count) {
  units_.gateway().count_lost_messages_by(std::move(count));
}

void Server::on_values(const process::Drive& drive, std::span<const process::SignalId> signals) {
  if (DriveUnit* const unit = units_.of_drive(drive.index())) {
    unit->on_values(signals);
  }
}

// Whether a value is fresh, and the rest of a drive, is asked anew at every read.
void Server::on_freshness(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) {}

void Server::on_commanded(const process::Drive& drive, std::span<const process::SignalId> signals) {
  on_values(drive, signals);
}

void Server::on_status(const process::Drive& /*drive*/) {}

void Server::on_alarm(const process::Drive& /*drive*/, alarms::AlarmKind /*kind*/) {}

void Server::on_bus(std::size_t /*bus*/) {}

}  // namespace modbus
