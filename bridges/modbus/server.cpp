#include "bridges/modbus/server.h"

#include <utility>

#include "bridges/modbus/connections.h"
#include "bridges/modbus/units.h"

namespace modbus {

class Server::Body {
 public:
  Body(boost::asio::any_io_executor executor, process::Plant& plant, const config::Modbus& settings)
      : units(plant, settings), connections(std::move(executor), settings, units) {}

  Units units;
  Connections connections;
};

Server::Server(boost::asio::any_io_executor executor, process::Plant& plant, const config::Modbus& settings)
    : body_(std::make_unique<Body>(std::move(executor), plant, settings)) {}

Server::~Server() = default;

void Server::start() {
  body_->connections.start();
}

void Server::close() {
  body_->connections.close();
}

boost::asio::awaitable<void> Server::stop() {
  co_await body_->connections.stop();
}

std::uint16_t Server::port(std::size_t listen_index) const {
  return body_->connections.port(listen_index);
}

std::size_t Server::clients() const noexcept {
  return body_->connections.clients();
}

std::uint64_t Server::refused() const noexcept {
  return body_->connections.refused();
}

void Server::set_mqtt_connected(bool connected) noexcept {
  body_->units.gateway().set_mqtt_connected(connected);
}

void Server::on_values(const process::Drive& drive, std::span<const process::SignalId> signals) {
  if (DriveUnit* const unit = body_->units.of_drive(drive.index())) {
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
