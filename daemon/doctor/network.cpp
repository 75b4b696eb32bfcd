#include "daemon/doctor/network.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/system/error_code.hpp>
#include <cerrno>

#include "bridges/net/privileged_port.h"
#include "daemon/doctor/port_owner.h"
#include "daemon/doctor/service_user.h"

namespace gateway::doctor {
namespace {

using boost::asio::ip::tcp;
using boost::system::error_code;

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

std::error_code try_to_bind(boost::asio::io_context& io, const tcp::endpoint& at) {
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
  // It does not listen: for that moment a client would be taken that is meant for the gateway.
  return failed;
}

// As the service would, which has no privilege.
bool is_refused_to_service(const tcp::endpoint& at) {
  const auto error = as_service_user([&at] {
    boost::asio::io_context io;
    return try_to_bind(io, at).value();
  });
  return error == EACCES;
}

Line judge_free(const config::Endpoint& listen, const PortFacts& facts, const PortHolder& holder) {
  const std::string subject = "port " + net::text_of(listen);
  if (facts.needs_privilege && holder.opener.empty()) {
    return {Verdict::warning, subject, fmt::format("free, but {} may not take it", kServiceUser),
            net::privileged_port_remedy(listen, holder.may_be_passed)};
  }
  if (holder.gateway == Presence::runs) {
    return {Verdict::warning, subject, "the gateway runs and does not listen there",
            "its log says why (`journalctl -u canopen-gateway`); or it has an older configuration"};
  }
  return {Verdict::ok, subject, facts.needs_privilege ? "free; opened by " + holder.opener : "free"};
}

Line judge_taken(const config::Endpoint& listen, const PortFacts& facts, Presence gateway) {
  const std::string subject = "port " + net::text_of(listen);
  const std::string who = fmt::format("`ss -ltnp 'sport = :{}'` as root names it", listen.port);
  if (facts.of_gateway == true) {
    return {Verdict::ok, subject, "the gateway listens there"};
  }
  if (facts.of_gateway == false) {
    return {Verdict::error, subject, "another program listens there, and the gateway, which runs, cannot",
            who + "; end it, or let `listen` name another port"};
  }
  switch (gateway) {
    case Presence::runs:
      return {Verdict::ok, subject, "in use, and the gateway runs; whether it is the one was not seen"};
    case Presence::absent:
      return {Verdict::error, subject, "another program listens there",
              who + "; end it, or let `listen` name another port"};
    case Presence::unknown:
      break;
  }
  return {Verdict::warning, subject, "in use, by the gateway or by another program", who};
}

}  // namespace

PortFacts try_port(const config::Endpoint& listen, pid_t gateway) {
  boost::asio::io_context io;
  PortFacts facts;
  for (const tcp::endpoint& at : look_up(io, listen, facts.unknown_name)) {
    if (const std::error_code failed = try_to_bind(io, at)) {
      facts.error = failed;
      facts.of_gateway = failed == std::errc::address_in_use ? is_held_by(at, gateway) : std::nullopt;
    } else if (listen.port < net::kFirstOrdinaryPort) {
      facts.needs_privilege = facts.needs_privilege || is_refused_to_service(at);
    }
  }
  return facts;
}

Line judge(const config::Endpoint& listen, const PortFacts& facts, const PortHolder& holder) {
  const std::string subject = "port " + net::text_of(listen);
  if (!facts.unknown_name.empty()) {
    return {Verdict::warning, subject, "no address is known for " + listen.host + ": " + facts.unknown_name,
            "the gateway tries again until there is one; a numeric address does not wait for a name server"};
  }
  if (!facts.error) {
    return judge_free(listen, facts, holder);
  }
  if (facts.error == std::errc::address_in_use) {
    return judge_taken(listen, facts, holder.gateway);
  }
  if (facts.error == std::errc::address_not_available) {
    return {Verdict::warning, subject, "this machine does not have that address now",
            "the gateway listens there as soon as it comes; `ip address` shows those that there are"};
  }
  if (facts.error == std::errc::permission_denied && listen.port < net::kFirstOrdinaryPort && !holder.privileged) {
    return {Verdict::warning, subject, "only root may try a port below 1024", "run this as root"};
  }
  return {Verdict::error, subject, facts.error.message(), "let `listen` name another address or port"};
}

std::string opener_of(const config::Endpoint& listen, const ServiceFacts& service, bool may_be_passed) {
  if (service.takes_any_port) {
    return "the service, by CAP_NET_BIND_SERVICE";
  }
  const bool passed =
      may_be_passed && std::ranges::find(service.sockets, net::text_of(listen)) != service.sockets.end();
  return passed ? "canopen-gateway.socket" : "";
}

BrokerFacts try_broker(const config::Mqtt& mqtt, const config::Endpoint& broker, bool lacks_files,
                       std::chrono::milliseconds patience) {
  boost::asio::io_context io;
  BrokerFacts facts{.lacks_files = lacks_files && broker.tls};
  for (const tcp::endpoint& at : look_up(io, broker, facts.unknown_name)) {
    facts.addresses.push_back(at.address().to_string());
  }
  if (facts.unknown_name.empty() && !facts.lacks_files) {
    facts.reach = mqtt::reaches(broker, facts.addresses,
                                {.ca = mqtt.ca_file, .cert = mqtt.cert_file, .key = mqtt.key_file}, patience);
    const bool doubtful = facts.reach.manner == mqtt::Manner::closes || facts.reach.manner == mqtt::Manner::foreign;
    facts.speaks_tls = doubtful && !broker.tls && mqtt::speaks_tls(broker, facts.addresses, patience);
  }
  return facts;
}

Line judge(const config::Endpoint& broker, const BrokerFacts& facts) {
  const std::string subject = "broker " + net::text_of(broker);
  if (!facts.unknown_name.empty()) {
    return {Verdict::error, subject, "no address is known for " + broker.host + ": " + facts.unknown_name,
            "is the name right, and the name server reachable: `getent ahosts " + broker.host + "`"};
  }
  if (facts.lacks_files) {
    return {Verdict::warning, subject, "not tried: a file for TLS is not there for this program",
            "its line above names it; the log of the gateway shows whether it connects (`journalctl -u "
            "canopen-gateway`)"};
  }
  if (facts.speaks_tls) {
    return {Verdict::error, subject, "what answers there speaks TLS, and is named without",
            fmt::format("let `brokers` name it as mqtts://{}, or name its port without TLS", net::text_of(broker))};
  }
  if (facts.reach.manner == mqtt::Manner::foreign) {
    return {Verdict::error, subject, facts.reach.why,
            broker.tls ? "does `brokers` name the right port: most listen for TLS at 8883"
                       : "does `brokers` name the right port: most listen at 1883; one for TLS, often 8883, needs "
                         "mqtts://"};
  }
  if (!facts.reach.good) {
    return {Verdict::error, subject,
            fmt::format("not reached at {}: {}", fmt::join(facts.addresses, ", "), facts.reach.why),
            "does the broker run there, and does no firewall stand between; the gateway goes on trying"};
  }
  if (facts.reach.manner != mqtt::Manner::connack) {
    return {
        Verdict::warning, subject, "it closes the connection without an answer: that may be a broker or not",
        "some brokers do that when asked for a version of MQTT that they do not know; `canopen-gateway status` tells "
        "whether the gateway is connected"};
  }
  return {Verdict::ok, subject, "something answers like a broker; user and password were not tried"};
}

}  // namespace gateway::doctor
