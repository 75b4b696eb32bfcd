#include "daemon/doctor/network.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/system/error_code.hpp>

namespace gateway::doctor {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

constexpr std::uint16_t kFirstFreePort = 1024;

std::string name_of(const config::Endpoint& endpoint) {
  const bool is_v6 = endpoint.host.find(':') != std::string::npos;
  return fmt::format("{}{}{}:{}", is_v6 ? "[" : "", endpoint.host, is_v6 ? "]" : "", endpoint.port);
}

std::vector<tcp::endpoint> look_up(boost::asio::io_context& io, const config::Endpoint& endpoint,
                                   std::string& unknown) {
  error_code failed;
  const auto found = tcp::resolver(io).resolve(endpoint.host, std::to_string(endpoint.port), failed);
  std::vector<tcp::endpoint> endpoints;
  if (failed) {
    unknown = failed.message();
    return endpoints;
  }
  for (const auto& entry : found) {
    endpoints.push_back(entry.endpoint());
  }
  return endpoints;
}

std::error_code try_to_listen(boost::asio::io_context& io, const tcp::endpoint& at) {
  tcp::acceptor acceptor(io);
  error_code failed;
  const auto worked = [&failed] { return !failed; };
  static_cast<void>(acceptor.open(at.protocol(), failed));
  if (worked() && at.protocol() == tcp::v6()) {
    static_cast<void>(acceptor.set_option(boost::asio::ip::v6_only(true), failed));
  }
  if (worked()) {
    static_cast<void>(acceptor.set_option(tcp::acceptor::reuse_address(true), failed));
  }
  if (worked()) {
    static_cast<void>(acceptor.bind(at, failed));
  }
  if (worked()) {
    static_cast<void>(acceptor.listen(1, failed));
  }
  return failed;
}

}  // namespace

PortFacts try_port(const config::Endpoint& listen) {
  boost::asio::io_context io;
  PortFacts facts;
  for (const tcp::endpoint& at : look_up(io, listen, facts.unknown_name)) {
    if (const std::error_code failed = try_to_listen(io, at)) {
      facts.error = failed;
    }
  }
  return facts;
}

Line judge(const config::Endpoint& listen, const PortFacts& facts, const PortHolder& holder) {
  const std::string subject = "port " + name_of(listen);
  if (!facts.unknown_name.empty()) {
    return {Verdict::warning, subject, "no address is known for " + listen.host + ": " + facts.unknown_name,
            "the gateway tries again until there is one; a numeric address does not wait for a name server"};
  }
  if (!facts.error) {
    return holder.gateway_runs
               ? Line{Verdict::warning, subject, "the gateway runs and does not listen there",
                      "its log says why (`journalctl -u canopen-gateway`); or it has an older configuration"}
               : Line{Verdict::ok, subject, "free"};
  }
  if (facts.error == std::errc::address_in_use) {
    return holder.gateway_runs
               ? Line{Verdict::ok, subject, "in use, and the gateway runs"}
               : Line{
                     Verdict::error, subject, "another program listens there",
                     fmt::format("`ss -ltnp 'sport = :{}'` as root names it; end it, or let `listen` name another port",
                                 listen.port)};
  }
  if (facts.error == std::errc::address_not_available) {
    return {Verdict::warning, subject, "this machine does not have that address now",
            "the gateway listens there as soon as it comes; `ip address` shows those that there are"};
  }
  if (facts.error == std::errc::permission_denied && listen.port < kFirstFreePort && !holder.privileged) {
    return {Verdict::warning, subject, "only root may try a port below 1024",
            "run this as root; the service may listen there"};
  }
  return {Verdict::error, subject, facts.error.message(), "let `listen` name another address or port"};
}

BrokerFacts try_broker(const config::Mqtt& mqtt, const config::Endpoint& broker, std::chrono::milliseconds patience) {
  boost::asio::io_context io;
  BrokerFacts facts;
  for (const tcp::endpoint& at : look_up(io, broker, facts.unknown_name)) {
    facts.addresses.push_back(at.address().to_string());
  }
  if (facts.unknown_name.empty()) {
    facts.reach = mqtt::reaches(broker, facts.addresses,
                                {.ca = mqtt.ca_file, .cert = mqtt.cert_file, .key = mqtt.key_file}, patience);
  }
  return facts;
}

Line judge(const config::Endpoint& broker, const BrokerFacts& facts) {
  const std::string subject = "broker " + name_of(broker);
  if (!facts.unknown_name.empty()) {
    return {Verdict::error, subject, "no address is known for " + broker.host + ": " + facts.unknown_name,
            "is the name right, and the name server reachable: `getent ahosts " + broker.host + "`"};
  }
  if (!facts.reach.good) {
    return {Verdict::error, subject,
            fmt::format("not reached at {}: {}", fmt::join(facts.addresses, ", "), facts.reach.why),
            "does the broker run there, and does no firewall stand between; the gateway goes on trying"};
  }
  return {Verdict::ok, subject, "something answers like a broker; user and password were not tried"};
}

}  // namespace gateway::doctor
