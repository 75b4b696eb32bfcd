#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bridges/journal/journal.h"
#include "bridges/modbus/server.h"
#include "bridges/mqtt/bridge.h"
#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/bus_watch.h"
#include "canopen/bus/link.h"
#include "canopen/clock.h"
#include "config/model.h"
#include "daemon/control/server.h"
#include "daemon/event_log.h"
#include "daemon/http/command_tally.h"
#include "daemon/http/history.h"
#include "daemon/http/live.h"
#include "daemon/http/server.h"
#include "daemon/http/site.h"
#include "daemon/kept_alarms.h"

namespace trace {
class Feed;
}
namespace canopen {
class BusSurvey;
}

namespace gateway {

class Recording;

/// Everything of one configuration, wired: buses, drives, bridges. `model` outlives it.
class Gateway {
 public:
  using LinkFactory = std::function<std::unique_ptr<canopen::Link>(const config::Bus&)>;

  /// `control_group`: of the control socket, see control::Place.
  Gateway(boost::asio::any_io_executor executor, const config::Model& model, const LinkFactory& make_link,
          const std::string& control_group = "canopen-gateway");
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  /// Starts everything; waits for no interface, address, broker or drive. `passed`: listening sockets of the service
  /// manager, by descriptor, which are owned from here on.
  void start(std::span<const int> passed = {});
  /// The orderly end: says so on MQTT, answers what is pending, sends nothing to drives.
  boost::asio::awaitable<void> stop();

  /// False: a thread of it stands still for good.
  [[nodiscard]] bool alive() const { return mqtt_ == nullptr || mqtt_->alive(); }

  [[nodiscard]] process::Plant& plant() noexcept { return plant_; }
  /// How it is, as `B/health` and `/health` show it.
  [[nodiscard]] process::Health health() const;
  /// How sound a bus is, by its position in config::Model::buses.
  [[nodiscard]] const canopen::BusSurvey& survey(std::size_t bus) const { return *buses_.at(bus).survey; }
  /// Of the HTTP server; 0 while it does not listen.
  [[nodiscard]] std::uint16_t http_port() const { return http_ ? http_->port() : std::uint16_t{0}; }

 private:
  /// A bus, and what hears of its state. The subscription goes before the bus.
  struct BusInUse {
    std::unique_ptr<canopen::Bus> bus;
    std::unique_ptr<canopen::BusWatch> watch{};
    canopen::BusTroubles troubles{};
    std::unique_ptr<canopen::BusSurvey> survey{};
    canopen::Subscription state{};
    canopen::Subscription timing{};
  };

  static std::vector<BusInUse> make_buses(const boost::asio::any_io_executor& executor, const config::Model& model,
                                          const LinkFactory& make_link);
  [[nodiscard]] http::Site http_site();
  [[nodiscard]] std::unique_ptr<trace::Feed> make_trace();
  void make_http(const boost::asio::any_io_executor& executor);
  /// Its state, timing, and who else is on it reach plant and log.
  void follow_bus(const boost::asio::any_io_executor& executor, std::size_t i);
  static std::vector<process::Plant::BusPort> ports(const std::vector<BusInUse>& buses);

  std::string instance_;  ///< Of this life of the program.
  canopen::TimePoint started_ = canopen::Clock::now();
  std::unique_ptr<journal::Journal> journal_;  ///< None where there is no state directory.
  std::vector<BusInUse> buses_;
  process::Plant plant_;
  EventLog event_log_;
  std::unique_ptr<KeptAlarms> kept_alarms_;  ///< None where there is no state directory.
  std::unique_ptr<Recording> recording_;     ///< None where nothing is to be recorded, or there is no state directory.
  std::unique_ptr<modbus::Server> modbus_;
  std::unique_ptr<mqtt::Bridge> mqtt_;
  std::unique_ptr<trace::Feed> trace_;  ///< Who reads it goes before.
  std::unique_ptr<control::Server> control_;
  http::CommandTally tally_;
  std::unique_ptr<http::Site> site_;  ///< What HTTP shows.
  std::unique_ptr<http::Live> live_;
  std::unique_ptr<http::History> history_;
  std::unique_ptr<http::Server> http_;
};

}  // namespace gateway
