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
#include "canopen/bus/link.h"
#include "canopen/clock.h"
#include "canopen/wake_up.h"
#include "config/difference.h"
#include "config/model.h"
#include "daemon/bus_in_use.h"
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

/// Everything of one configuration, wired: buses, drives, bridges.
///
/// Parts: gateway.cpp begin and end; gateway_parts.cpp what makes the bridges; gateway_change.cpp how it takes another
/// configuration while it runs.
class Gateway {
 public:
  using LinkFactory = std::function<std::unique_ptr<canopen::Link>(const config::Bus&)>;

  /// `control_group`: of the control socket, see control::Place.
  Gateway(boost::asio::any_io_executor executor, std::shared_ptr<const config::Model> model, LinkFactory make_link,
          const std::string& control_group = "canopen-gateway");
  /// The same with a model that outlives it.
  Gateway(boost::asio::any_io_executor executor, const config::Model& model, LinkFactory make_link,
          const std::string& control_group = "canopen-gateway");
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  /// Starts everything; waits for no interface, address, broker or drive. `passed`: listening sockets of the service
  /// manager, by descriptor, which are owned from here on.
  void start(std::span<const int> passed = {});
  /// Of another configuration, checked, with the same [gateway], between start() and stop(): [http], [recorder] and
  /// [mqtt], one after the other; each is begun anew as soon as the old one has ended, for which a broker may keep it
  /// waiting for seconds. Those that are the same, and all drives, do not notice. Neither this nor change() before the
  /// last call of either has returned. `wanted` outlives it.
  boost::asio::awaitable<void> change_sections(const config::Model& wanted);
  /// Likewise all the rest of it: drives, buses and [modbus]. Drives are replaced whether their motor turns or not: see
  /// Reload. Those that leave take no command any more as soon as this is awaited, before anything is waited for. Their
  /// end is awaited, which takes some turns of the loop. Throws where a bus cannot be made; then nothing has changed.
  boost::asio::awaitable<void> change(std::shared_ptr<const config::Model> model);
  /// stop() follows: a change under way begins nothing any more.
  void end_is_near() noexcept { ending_ = true; }
  /// The orderly end: says so on MQTT, answers what is pending, sends nothing to drives.
  boost::asio::awaitable<void> stop();

  /// False: a thread of it stands still for good.
  [[nodiscard]] bool alive() const { return mqtt_ == nullptr || mqtt_->alive(); }

  [[nodiscard]] process::Plant& plant() noexcept { return plant_; }
  /// How it is, as `B/health` and `/health` show it.
  [[nodiscard]] process::Health health() const;
  /// How sound a bus is, by its position in config::Model::buses.
  [[nodiscard]] const canopen::BusSurvey& survey(std::size_t bus) const { return buses_.at(bus)->survey(); }
  /// Of the HTTP server; 0 while it does not listen.
  [[nodiscard]] std::uint16_t http_port() const { return http_ ? http_->port() : std::uint16_t{0}; }

 private:
  using Buses = std::vector<std::unique_ptr<BusInUse>>;
  using Model = std::shared_ptr<const config::Model>;

  [[nodiscard]] std::unique_ptr<BusInUse> make_bus(const config::Bus& settings) const;
  [[nodiscard]] static Buses make_buses(const Gateway& gateway, const config::Model& model);
  [[nodiscard]] std::vector<process::Plant::BusPort> ports() const;
  [[nodiscard]] std::vector<canopen::Bus*> bus_list() const;

  // What [modbus], [mqtt], [recorder], [http] ask for; nothing where there is no such section. Each is added to the
  // plant's observers.
  void make_modbus();
  void make_mqtt();
  void make_recorder();
  void make_http();
  void make_control(const std::string& group);
  void start_modbus(std::span<const int> passed);
  void start_http();
  /// Who asks the site is shown what there is now.
  void fill_site();

  /// Stopped, but a coroutine or a thread of theirs may not have ended yet.
  struct Left {
    Model model;
    std::unique_ptr<Recording> recording{};
    std::unique_ptr<modbus::Server> modbus{};
    std::unique_ptr<mqtt::Bridge> mqtt{};
    std::unique_ptr<http::Server> http{};
  };

  /// That section is as wanted, nothing else is another.
  template <class Section>
  void take_section(Section config::Model::* section, const config::Model& wanted);
  void change_http(const config::Model& wanted);
  boost::asio::awaitable<void> change_recorder(const config::Model& wanted);
  boost::asio::awaitable<void> change_mqtt(const config::Model& wanted);
  void begin_modbus();
  [[nodiscard]] Buses make_new_buses(const config::Model& model) const;
  /// It is the plant's. What it has no more is stopped. `made`: its new buses, by their positions.
  void take(Model model, Buses made);
  void start_bus(std::size_t bus);
  void leave(Left left);
  void forget_left();
  boost::asio::awaitable<void> stop_left();

  boost::asio::any_io_executor executor_;
  LinkFactory make_link_;
  std::string instance_;  ///< Of this life of the program.
  canopen::TimePoint started_ = canopen::Clock::now();
  std::unique_ptr<journal::Journal> journal_;  ///< None where there is no state directory.
  Buses left_buses_;                           ///< Stopped; drives that left still know them.
  Buses buses_;
  process::Plant plant_;
  EventLog event_log_;
  std::unique_ptr<KeptAlarms> kept_alarms_;  ///< None where there is no state directory.
  // Of each bridge the model whose section it has.
  std::unique_ptr<Recording> recording_;  ///< None where nothing is to be recorded, or there is no state directory.
  Model modbus_model_;
  std::unique_ptr<modbus::Server> modbus_;
  Model mqtt_model_;
  std::unique_ptr<mqtt::Bridge> mqtt_;
  std::vector<int> passed_;             ///< Duplicates of the service manager's sockets.
  std::unique_ptr<trace::Feed> trace_;  ///< Who reads it goes before.
  std::unique_ptr<control::Server> control_;
  std::unique_ptr<http::CommandTally> tally_;
  std::unique_ptr<http::Site> site_;  ///< What HTTP shows.
  std::unique_ptr<http::Live> live_;
  std::unique_ptr<http::History> history_;
  Model http_model_;
  std::unique_ptr<http::Server> http_;
  std::vector<Left> left_;
  canopen::WakeUp forget_;
  bool ending_ = false;
};

}  // namespace gateway
