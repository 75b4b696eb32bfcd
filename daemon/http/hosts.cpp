#include "daemon/http/hosts.h"

#include <algorithm>
#include <utility>

#include "bridges/net/access_list.h"

namespace gateway::http {
namespace {

namespace ip = boost::asio::ip;

bool is_name_letter(char c) noexcept {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
}

bool is_port(std::string_view text) {
  return text.size() <= 5 && text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

std::optional<std::string> host_of(std::string_view header) {
  std::string_view name = header;
  std::string_view port;
  const bool bracketed = header.starts_with('[');
  const std::size_t colon = bracketed ? header.find("]:") : header.find(':');
  if (colon != std::string_view::npos) {
    name = header.substr(0, colon + (bracketed ? 1 : 0));
    port = header.substr(colon + (bracketed ? 2 : 1));
  }
  if (name.empty() || !is_port(port)) {
    return std::nullopt;
  }
  boost::system::error_code failed;
  if (bracketed) {
    if (!name.ends_with(']')) {
      return std::nullopt;
    }
    const auto address = ip::make_address_v6(std::string(name.substr(1, name.size() - 2)), failed);
    return failed ? std::nullopt : std::optional(net::plain_address(address).to_string());
  }
  std::string host(name);
  std::ranges::transform(host, host.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  if (host.size() > 1 && host.ends_with('.')) {
    host.pop_back();
  }
  return std::ranges::all_of(host, is_name_letter) ? std::optional(std::move(host)) : std::nullopt;
}

Hosts::Hosts(std::vector<std::string> further) : further_(std::move(further)) {
  for (std::string& name : further_) {
    if (name.size() > 1 && name.ends_with('.')) {
      name.pop_back();
    }
  }
}

bool Hosts::knows(std::string_view header, const ip::address& own) const {
  const std::optional<std::string> host = host_of(header);
  if (!host) {
    return false;
  }
  boost::system::error_code failed;
  const auto address = ip::make_address(*host, failed);
  if (!failed) {
    // Without the interface that a link-local address of ours comes with.
    const ip::address plain = net::plain_address(own);
    const bool is_own =
        plain.is_v6() && address.is_v6() ? plain.to_v6().to_bytes() == address.to_v6().to_bytes() : plain == address;
    return address.is_loopback() || is_own || std::ranges::count(further_, *host) != 0;
  }
  return *host == "localhost" || host->ends_with(".localhost") || std::ranges::count(further_, *host) != 0;
}

}  // namespace gateway::http
