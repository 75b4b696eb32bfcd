#include "daemon/demo_site.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/system/error_code.hpp>
#include <utility>

#include "daemon/demo_name.h"

namespace gateway {
namespace {

constexpr std::string_view kLoopback = "127.0.0.1";
constexpr std::uint16_t kModbusPort = 1502;
constexpr std::uint16_t kHttpPort = 9465;
constexpr std::uint16_t kLeastPort = 1024;  // Below, only root may listen.
constexpr std::uint16_t kPlantModbusPort = 502;
constexpr std::uint16_t kPlantHttpPort = 9464;
constexpr std::size_t kLongestName = 32;

bool is_loopback(const std::string& host) {
  boost::system::error_code not_numeric;
  const auto address = boost::asio::ip::make_address(host, not_numeric);
  return not_numeric ? host == "localhost" : address.is_loopback();
}

bool may_be_a_plant(const config::Model& model) {
  return std::ranges::any_of(model.buses,
                             [](const config::Bus& bus) { return bus.interface != config::kVirtualInterface; });
}

// What looks for the plant at a port that the site names is not to find the demo there, whatever the address was.
Ports ports_of_plant(const config::Model& model) {
  Ports ports{kPlantModbusPort, kPlantHttpPort};
  if (!may_be_a_plant(model)) {
    return ports;
  }
  if (model.modbus) {
    for (const config::Endpoint& listen : model.modbus->listen) {
      ports.insert(listen.port);
    }
  }
  if (model.http) {
    ports.insert(model.http->listen.port);
  }
  return ports;
}

bool is_of_plant(const config::Endpoint& endpoint, const Ports& plant) {
  return !is_loopback(endpoint.host) || endpoint.port < kLeastPort || plant.contains(endpoint.port);
}

config::Endpoint own(std::uint16_t port, const Ports& plant) {
  while (plant.contains(port)) {
    ++port;
  }
  return {.host = std::string(kLoopback), .port = port};
}

void keep_modbus_here(config::Modbus& modbus, const Ports& plant) {
  std::vector<config::Endpoint> listen;
  for (const config::Endpoint& stated : modbus.listen) {
    const config::Endpoint here = is_of_plant(stated, plant) ? own(kModbusPort, plant) : stated;
    if (std::ranges::find(listen, here) == listen.end()) {
      listen.push_back(here);
    }
  }
  modbus.listen = std::move(listen);
  modbus.read_from = config::Modbus{}.write_from;
  modbus.write_from = config::Modbus{}.write_from;
}

void keep_mqtt_here(config::Mqtt& mqtt) {
  std::erase_if(mqtt.brokers, [](const config::Endpoint& broker) { return !is_loopback(broker.host); });
  if (mqtt.brokers.empty()) {
    mqtt.brokers = config::Mqtt{}.brokers;
    mqtt.username.clear();  // They were meant for another broker.
    mqtt.password_file.clear();
    mqtt.ca_file.clear();
    mqtt.cert_file.clear();
    mqtt.key_file.clear();
  }
  if (!mqtt.client_id.empty()) {
    mqtt.client_id += "-demo";
  }
}

bool is_taken(const config::Endpoint& endpoint) {
  boost::asio::io_context unused;
  boost::asio::ip::tcp::acceptor acceptor(unused);
  boost::system::error_code failed;
  const auto address =
      boost::asio::ip::make_address(endpoint.host == "localhost" ? std::string(kLoopback) : endpoint.host, failed);
  const boost::asio::ip::tcp::endpoint place(address, endpoint.port);
  acceptor.open(place.protocol(), failed);
  if (!failed) {
    acceptor.set_option(boost::asio::socket_base::reuse_address(true), failed);
  }
  if (!failed) {
    acceptor.bind(place, failed);
  }
  if (!failed) {
    acceptor.listen(1, failed);
  }
  return failed == boost::asio::error::address_in_use;
}

/// Puts listeners to ports that nobody has: no other program, no plant, and none of the listeners before.
class FreePorts {
 public:
  explicit FreePorts(const Ports& plant) : plant_(plant) {}

  void step_aside(config::Endpoint& endpoint, std::string_view what, std::vector<std::string>& told) {
    constexpr int kTries = 50;
    const config::Endpoint wanted = endpoint;
    for (int i = 0; i < kTries && endpoint.port != 0 && has_owner(endpoint); ++i) {
      ++endpoint.port;
    }
    given_.push_back(endpoint);
    if (endpoint.port != wanted.port) {
      told.push_back(fmt::format("Port {} is taken, by another demo or gateway perhaps: {} is on port {}.", wanted.port,
                                 what, endpoint.port));
    }
  }

 private:
  [[nodiscard]] bool has_owner(const config::Endpoint& endpoint) const {
    return plant_.contains(endpoint.port) || std::ranges::find(given_, endpoint) != given_.end() || is_taken(endpoint);
  }

  const Ports& plant_;
  std::vector<config::Endpoint> given_;
};

}  // namespace

std::string demo_name(std::string_view name) {
  constexpr std::string_view kTail = "-demo";
  const std::size_t room = kLongestName - kTail.size();
  std::string demo = std::string(name.substr(0, room)).append(kTail);
  if (demo == name) {  // As long as may be, and with that tail.
    demo = std::string(name.substr(0, room - 1)).append(kTail);
  }
  return demo;
}

Ports make_demo(config::Model& model, DemoOf of) {
  const Ports plant = ports_of_plant(model);
  if (of == DemoOf::given_site) {
    model.gateway.name = demo_name(model.gateway.name);
  }
  if (model.modbus) {
    keep_modbus_here(*model.modbus, plant);
  }
  if (model.mqtt) {
    if (may_be_a_plant(model)) {
      model.mqtt->home_assistant.clear();  // A broker on this machine may be the one that the plant's listens to.
    }
    keep_mqtt_here(*model.mqtt);
  }
  if (!model.http) {
    model.http.emplace();
  }
  config::Endpoint& http = model.http->listen;
  if (is_of_plant(http, plant)) {
    http = own(kHttpPort, plant);
  }
  model.http->read_from = config::Http{}.read_from;
  return plant;
}

std::vector<std::string> step_aside(config::Model& model, const Ports& plant) {
  std::vector<std::string> told;
  FreePorts ports(plant);
  ports.step_aside(model.http->listen, "the page", told);
  if (model.modbus) {
    for (config::Endpoint& listen : model.modbus->listen) {
      ports.step_aside(listen, "Modbus", told);
    }
  }
  return told;
}

}  // namespace gateway
