#include "daemon/demo_site.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/system/error_code.hpp>

#include "daemon/demo_name.h"

namespace gateway {
namespace {

constexpr std::string_view kLoopback = "127.0.0.1";
constexpr std::uint16_t kModbusPort = 1502;
constexpr std::uint16_t kHttpPort = 9465;
constexpr std::uint16_t kLeastPort = 1024;  // Below, only root may listen.
constexpr std::uint16_t kPlantHttpPort = 9464;
constexpr std::size_t kLongestName = 32;
constexpr std::string_view kOwnName = "demo";

bool is_loopback(const std::string& host) {
  boost::system::error_code not_numeric;
  const auto address = boost::asio::ip::make_address(host, not_numeric);
  return not_numeric ? host == "localhost" : address.is_loopback();
}

config::Endpoint own(std::uint16_t port) {
  return {.host = std::string(kLoopback), .port = port};
}

void keep_modbus_here(config::Modbus& modbus) {
  for (config::Endpoint& listen : modbus.listen) {
    if (!is_loopback(listen.host) || listen.port < kLeastPort) {
      listen = own(kModbusPort);
    }
  }
  const auto [first, last] = std::ranges::unique(modbus.listen);
  modbus.listen.erase(first, last);
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

void step_aside(config::Endpoint& endpoint, std::string_view what, std::vector<std::string>& told) {
  constexpr int kTries = 50;
  const config::Endpoint wanted = endpoint;
  for (int i = 0; i < kTries && endpoint.port != 0 && is_taken(endpoint); ++i) {
    ++endpoint.port;
  }
  if (endpoint.port != wanted.port) {
    told.push_back(fmt::format("Port {} is taken, by another demo or gateway perhaps: {} is on port {}.", wanted.port,
                               what, endpoint.port));
  }
}

}  // namespace

std::string demo_name(std::string_view name) {
  constexpr std::string_view kTail = "-demo";
  if (name == kOwnName) {
    return std::string(name);
  }
  return std::string(name.substr(0, kLongestName - kTail.size())).append(kTail);
}

void make_demo(config::Model& model) {
  model.gateway.name = demo_name(model.gateway.name);
  if (model.modbus) {
    keep_modbus_here(*model.modbus);
  }
  if (model.mqtt) {
    keep_mqtt_here(*model.mqtt);
  }
  if (!model.http) {
    model.http.emplace();
  }
  config::Endpoint& http = model.http->listen;
  if (!is_loopback(http.host) || http.port < kLeastPort || http.port == kPlantHttpPort) {
    http = own(kHttpPort);
  }
  model.http->read_from = config::Http{}.read_from;
}

std::vector<std::string> step_aside(config::Model& model) {
  std::vector<std::string> told;
  step_aside(model.http->listen, "the page", told);
  if (model.modbus) {
    for (config::Endpoint& listen : model.modbus->listen) {
      step_aside(listen, "Modbus", told);
    }
  }
  return told;
}

}  // namespace gateway
