#include "config/site/endpoint.h"

#include <algorithm>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/network_v4.hpp>
#include <boost/asio/ip/network_v6.hpp>
#include <string>

#include "config/text.h"

namespace config {
namespace {

namespace ip = boost::asio::ip;
using boost::system::error_code;

/// Addresses that a server can have and a client can reach: neither a multicast nor the broadcast one, nor IPv4 in the
/// clothes of IPv6, whose socket takes no IPv4.
bool is_host_address(const ip::address& address) {
  const bool mapped = address.is_v6() && address.to_v6().is_v4_mapped();
  return !mapped && !address.is_multicast() && address != ip::address(ip::address_v4::broadcast());
}

bool is_v4_host(std::string_view host) {
  error_code failed;
  const auto address = ip::make_address_v4(std::string(host), failed);
  return !failed && is_host_address(address);
}

/// A host name (RFC 1123, with the underscore that many have), or an IPv4 address. What ends in a number is an address:
/// the system would read 0x7f.1 as one (RFC 3986 §7.4).
bool is_host(std::string_view host) {
  constexpr std::size_t kLongestHost = 253;
  const bool letters =
      !host.empty() && host.size() <= kLongestHost && std::all_of(host.begin(), host.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
               c == '_';
      });
  if (!letters) {
    return false;
  }
  host.remove_suffix(host.ends_with('.') ? 1 : 0);
  const std::string_view last = host.substr(host.rfind('.') + 1);
  if (last.find_first_not_of("0123456789") == std::string_view::npos || last.starts_with("0x") ||
      last.starts_with("0X")) {
    return is_v4_host(host);
  }
  const std::string dotted = "." + std::string(host) + ".";
  return dotted.find("..") == std::string::npos && dotted.find(".-") == std::string::npos &&
         dotted.find("-.") == std::string::npos;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return text;
}

/// One without a scope, which belongs to one machine.
bool is_v6_host(std::string_view host) {
  error_code failed;
  const auto address = ip::make_address_v6(std::string(host), failed);
  return !failed && is_host_address(address) &&
         host.find_first_of(std::string_view("\0%", 2)) == std::string_view::npos;
}

/// The address of a numeric host; nothing for a name other than localhost, which stands for both loopback ones.
std::optional<ip::address> address_of(const std::string& host, bool v6) {
  error_code failed;
  auto address = ip::make_address(host, failed);
  if (!failed) {
    return address;
  }
  if (host == "localhost") {
    return v6 ? ip::address(ip::address_v6::loopback()) : ip::address(ip::address_v4::loopback());
  }
  return std::nullopt;
}

std::string network_text(const ip::address& address, unsigned prefix) {
  return address.to_string() + "/" + std::to_string(prefix);
}

/// The network that starts at an address with so many bits: nothing lies beyond them.
ip::address first_of(const ip::address& address, unsigned prefix) {
  if (address.is_v4()) {
    return ip::network_v4(address.to_v4(), static_cast<unsigned short>(prefix)).network();
  }
  return ip::network_v6(address.to_v6(), static_cast<unsigned short>(prefix)).network();
}

struct Parts {
  ip::address address;
  unsigned prefix = 0;
};

std::optional<Parts> parse_network(std::string_view text) {
  const auto slash = text.find('/');
  error_code failed;
  const auto address = ip::make_address(std::string(text.substr(0, slash)), failed);
  if (failed || text.find_first_of(std::string_view("\0%", 2)) != std::string_view::npos) {
    return std::nullopt;
  }
  const unsigned longest = address.is_v4() ? 32 : 128;
  if (slash == std::string_view::npos) {
    return Parts{address, longest};
  }
  const auto prefix = parse_decimal(text.substr(slash + 1));
  if (!prefix.has_value() || *prefix > longest) {
    return std::nullopt;
  }
  return Parts{address, static_cast<unsigned>(*prefix)};
}

std::optional<Network> read_network(const Node& node, const Complaint& complain) {
  if (!expect(node, NodeKind::text, complain, "\"192.168.1.0/24\"")) {
    return std::nullopt;
  }
  const auto parts = parse_network(node.text);
  if (!parts.has_value()) {
    complain.value(node.place,
                   in_quotes(node.text) + " must be a network such as \"192.168.1.0/24\" or one numeric address");
    return std::nullopt;
  }
  constexpr unsigned kMapped = 96;  // ::ffff:0:0/96, RFC 4291 §2.5.5.2
  if (parts->address.is_v6() && parts->address.to_v6().is_v4_mapped() && parts->prefix >= kMapped) {
    const auto plain = ip::make_address_v4(ip::v4_mapped, parts->address.to_v6());
    complain.value(node.place, in_quotes(node.text) + " is IPv4 and must be written so: \"" +
                                   network_text(first_of(plain, parts->prefix - kMapped), parts->prefix - kMapped) +
                                   "\"");
    return std::nullopt;
  }
  const auto first = first_of(parts->address, parts->prefix);
  if (first != parts->address) {
    complain.value(node.place, in_quotes(node.text) + " has bits beyond its prefix; the network is \"" +
                                   network_text(first, parts->prefix) + "\"");
    return std::nullopt;
  }
  return Network{.address = first.to_string(), .prefix = parts->prefix};
}

std::optional<Endpoint> read_broker(const Node& node, const Complaint& complain) {
  constexpr std::string_view kScheme = "mqtt://";
  constexpr std::string_view kTlsScheme = "mqtts://";
  if (!expect(node, NodeKind::text, complain, "\"mqtt://127.0.0.1:1883\"")) {
    return std::nullopt;
  }
  if (node.text.find('@') != std::string::npos) {
    // Not shown: what stands before the '@' is mostly a password.
    complain.value(node.place, "must be mqtt://HOST:PORT; a name goes to username, and a password into password_file");
    return std::nullopt;
  }
  const bool tls = node.text.starts_with(kTlsScheme);
  const bool schemed = tls || node.text.starts_with(kScheme);
  const std::size_t scheme = (tls ? kTlsScheme : kScheme).size();
  auto broker = schemed ? parse_endpoint(std::string_view(node.text).substr(scheme)) : std::nullopt;
  if (!broker.has_value()) {
    complain.value(node.place, in_quotes(node.text) +
                                   " must be mqtt://HOST:PORT, such as \"mqtt://127.0.0.1:1883\", or "
                                   "mqtts://HOST:PORT for TLS");
    return std::nullopt;
  }
  broker->tls = tls;
  return broker;
}

std::string shown(const Endpoint& endpoint) {
  const bool bracketed = endpoint.host.find(':') != std::string::npos;
  return (bracketed ? "[" + endpoint.host + "]" : endpoint.host) + ":" + std::to_string(endpoint.port);
}

}  // namespace

std::optional<Endpoint> parse_endpoint(std::string_view text) {
  constexpr std::int64_t kLastPort = 65535;
  const auto colon = text.rfind(':');
  const auto port = colon == std::string_view::npos ? std::nullopt : parse_decimal(text.substr(colon + 1));
  if (!port.has_value() || *port < 1 || *port > kLastPort) {
    return std::nullopt;
  }
  std::string_view host = text.substr(0, colon);
  const bool bracketed = host.starts_with('[') && host.ends_with(']');
  host = bracketed ? host.substr(1, host.size() - 2) : host;
  if (bracketed ? !is_v6_host(host) : !is_host(host)) {
    return std::nullopt;
  }
  // One spelling of every host, so that equal ones are found equal.
  std::string plain = bracketed ? ip::make_address_v6(std::string(host)).to_string() : std::string(host);
  return Endpoint{.host = lower(std::move(plain)), .port = static_cast<std::uint16_t>(*port)};
}

Form<Endpoint> endpoint(std::uint16_t port) {
  return {
      .type = "string",
      .read = [port = std::to_string(port)](const Node& node, const Complaint& complain) -> std::optional<Endpoint> {
        if (!expect(node, NodeKind::text, complain, "\"0.0.0.0:" + port + "\"")) {
          return std::nullopt;
        }
        auto value = parse_endpoint(node.text);
        if (!value.has_value()) {
          complain.value(node.place, in_quotes(node.text) + " must be an address and a port, such as \"0.0.0.0:" +
                                         port + "\" or \"[::]:" + port + "\"");
        }
        return value;
      },
      .show = shown};
}

Form<std::string> host() {
  return {.type = "string",
          .read = [](const Node& node, const Complaint& complain) -> std::optional<std::string> {
            if (!expect(node, NodeKind::text, complain, "\"line3.plant.example\"")) {
              return std::nullopt;
            }
            const bool v6 = is_v6_host(node.text);
            if (!v6 && !is_host(node.text)) {
              complain.value(node.place, in_quotes(node.text) +
                                             " must be a host name or a numeric address, without a port, such as "
                                             "\"line3.plant.example\"");
              return std::nullopt;
            }
            return v6 ? ip::make_address_v6(node.text).to_string() : lower(node.text);
          },
          .show = [](const std::string& host) { return host; }};
}

Form<Endpoint> broker() {
  return {.type = "string", .read = read_broker, .show = [](const Endpoint& endpoint) {
            return (endpoint.tls ? "mqtts://" : "mqtt://") + shown(endpoint);
          }};
}

Form<Network> network() {
  return {.type = "string", .read = read_network, .show = [](const Network& network) {
            return network.address + "/" + std::to_string(network.prefix);
          }};
}

bool is_link_local(const Endpoint& endpoint) {
  error_code failed;
  const auto address = ip::make_address_v6(endpoint.host, failed);
  return !failed && address.is_link_local();
}

bool covers(const Endpoint& outer, const Endpoint& inner) {
  if (outer.port != inner.port) {
    return false;
  }
  for (const bool v6 : {false, true}) {
    const auto wide = address_of(outer.host, v6);
    const auto narrow = address_of(inner.host, v6);
    if (wide.has_value() && narrow.has_value() && wide->is_v4() == narrow->is_v4() &&
        (*wide == *narrow || wide->is_unspecified())) {
      return true;
    }
  }
  return outer.host == inner.host;
}

bool can_arrive(const Network& from, const Endpoint& listen) {
  const auto first = ip::make_address(from.address);
  const auto at = address_of(listen.host, first.is_v6());
  if (!at.has_value()) {
    return true;  // a name may stand for any address
  }
  const Network loopback = first.is_v4() ? Network{"127.0.0.0", 8} : Network{"::1", 128};
  return at->is_v4() == first.is_v4() && (!at->is_loopback() || meet(from, loopback));
}

bool meet(const Network& one, const Network& other) {
  return covers(one, other) || covers(other, one);
}

bool covers(const Network& outer, const Network& inner) {
  const auto outer_address = ip::make_address(outer.address);
  const auto inner_address = ip::make_address(inner.address);
  return outer_address.is_v4() == inner_address.is_v4() && outer.prefix <= inner.prefix &&
         first_of(inner_address, outer.prefix) == outer_address;
}

}  // namespace config
