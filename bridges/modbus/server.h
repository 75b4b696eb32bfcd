#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "bridges/modbus/connections.h"
#include "bridges/modbus/counts.h"
#include "bridges/modbus/units.h"
#include "bridges/net/connection_log.h"
#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "config/model.h"

namespace modbus {

/// The Modbus TCP server: every drive with a unit id is a unit, the gateway itself answers under 0 and 255.
/// One loop, one thread.
class Server final : public process::Observer {
 public:
  /// `plant` outlives the server. Its drives and buses may change; other settings need another server. Whoever creates
  /// it adds it to the plant's observers before the plant starts. Throws std::runtime_error for address ranges that are
  /// none.
  Server(const boost::asio::any_io_executor& executor, process::Plant& plant, const config::Modbus& settings,
         net::Notices notices = {});
  /// After stop(), or after the loop has ended.
  ~Server() = default;
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Listens: on `passed`, sockets that a service manager bound and that are owned from here on, where an entry of
  /// `listen` has just that address and port, else on its own. Never fails; what cannot be opened yet is told and
  /// tried again.
  void start(std::span<const int> passed = {}) { connections_.start(passed); }
  /// Ends listeners and connections; nothing more is asked of a drive. Another server may listen there at once.
  void close() { connections_.close(); }
  /// The same for this reason, which the log says.
  void close(const char* why) { connections_.close(why); }
  /// After close(): no command of a client is in progress any more.
  [[nodiscard]] bool ended() const noexcept { return connections_.ended(); }
  /// The same; returns when no command of a client is in progress any more, at the latest after the longest deadline of
  /// a command, or soon after the plant was stopped.
  boost::asio::awaitable<void> stop() { return connections_.stop(); }

  /// The port that config::Modbus::listen[listen_index] got, where the configuration says 0. 0 while nothing listens.
  [[nodiscard]] std::uint16_t port(std::size_t listen_index) const { return connections_.port(listen_index); }
  /// Connected now.
  [[nodiscard]] std::size_t clients() const noexcept { return connections_.clients(); }
  /// Connections closed at once since the start: not from `read_from`, or no room for them.
  [[nodiscard]] std::uint64_t refused() const noexcept { return connections_.refused(); }
  /// What was asked since the start.
  [[nodiscard]] const Counts& counts() const noexcept { return connections_.counts(); }

  /// Register 4 of the gateway unit.
  void set_mqtt_connected(bool connected) noexcept { units_.gateway().set_mqtt_connected(connected); }
  /// Register 7 of the gateway unit: the messages that the log lost. `count` is asked at every read.
  void count_lost_messages_by(std::function<std::uint64_t()> count);

  void on_values(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_freshness(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_commanded(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_status(const process::Drive& drive) override;
  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind) override;
  void on_bus(std::size_t bus) override;
  void on_plant_change(const process::PlantChange& change) override { units_.change(change); }

 private:
  config::Modbus settings_;  ///< Its own: the model that it came from may go.
  Units units_;
  Connections connections_;
};

}  // namespace modbus
