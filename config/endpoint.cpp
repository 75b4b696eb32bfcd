#include "config/endpoint.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "config/text.h"

namespace config {
namespace {

using AddressBytes = std::array<std::uint8_t, sizeof(in6_addr)>;

int family_of(std::string_view address) {
  return address.find(':') == std::string_view::npos ? AF_INET : AF_INET6;
}

bool is_host(std::string_view host) {
  return !host.empty() && host.size() <= 253 && std::all_of(host.begin(), host.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == '_';
  });
}

bool is_address(std::string_view text) {
  AddressBytes bytes{};
  return inet_pton(family_of(text), std::string(text).c_str(), bytes.data()) == 1;
}

}  // namespace

std::optional<Endpoint> parse_endpoint(std::string_view text) {
  const auto colon = text.rfind(':');
  if (colon == std::string_view::npos || text.find('\0') != std::string_view::npos) {
    return std::nullopt;
  }
  const auto port = parse_integer(text.substr(colon + 1));
  if (!port.has_value() || *port < 1 || *port > 65535) {
    return std::nullopt;
  }
  std::string_view host = text.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) {
    host = host.substr(1, host.size() - 2);
    if (family_of(host) != AF_INET6 || !is_address(host)) {
      return std::nullopt;
    }
  } else if (!is_host(host)) {
    return std::nullopt;
  }
  return Endpoint{.host = std::string(host), .port = static_cast<std::uint16_t>(*port)};
}

std::optional<Network> parse_network(std::string_view text) {
  if (text.find('\0') != std::string_view::npos) {
    return std::nullopt;
  }
  const auto slash = text.find('/');
  const std::string_view address = text.substr(0, slash);
  if (!is_address(address)) {
    return std::nullopt;
  }
  const unsigned longest = family_of(address) == AF_INET ? 32 : 128;
  if (slash == std::string_view::npos) {
    return Network{.address = std::string(address), .prefix = longest};
  }
  const auto prefix = parse_integer(text.substr(slash + 1));
  if (!prefix.has_value() || *prefix < 0 || *prefix > longest) {
    return std::nullopt;
  }
  return Network{.address = std::string(address), .prefix = static_cast<unsigned>(*prefix)};
}

Network masked(const Network& network) {
  const int family = family_of(network.address);
  AddressBytes bytes{};
  if (inet_pton(family, network.address.c_str(), bytes.data()) != 1) {
    return network;
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const unsigned kept =
        network.prefix > i * 8 ? std::min<unsigned>(network.prefix - static_cast<unsigned>(i * 8), 8) : 0;
    bytes.at(i) = static_cast<std::uint8_t>(bytes.at(i) & (0xFF00U >> kept));
  }
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (inet_ntop(family, bytes.data(), text.data(), text.size()) == nullptr) {
    return network;
  }
  return {.address = text.data(), .prefix = network.prefix};
}

}  // namespace config
