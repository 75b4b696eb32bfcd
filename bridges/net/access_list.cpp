#include "bridges/net/access_list.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace net {

namespace ip = boost::asio::ip;

ip::address plain_address(const ip::address& address) {
  if (address.is_v6() && address.to_v6().is_v4_mapped()) {
    return ip::make_address_v4(ip::v4_mapped, address.to_v6());
  }
  return address;
}

AccessList::AccessList(const std::vector<config::Network>& networks, const char* key) {
  for (const config::Network& network : networks) {
    const std::string text = network.address + "/" + std::to_string(network.prefix);
    boost::system::error_code no_v4;
    boost::system::error_code no_v6;
    const auto v4 = ip::make_network_v4(text, no_v4);
    const auto v6 = ip::make_network_v6(text, no_v6);
    if (!no_v4) {
      v4_.push_back(v4.canonical());
    } else if (!no_v6) {
      v6_.push_back(v6.canonical());
    } else {
      throw std::runtime_error(std::string(key) + ": \"" + text +
                               "\" is no network; write it as 192.0.2.0/24 or 2001:db8::/32");
    }
  }
}

bool AccessList::contains(const ip::address& address) const noexcept {
  // Asio knows only whether one network lies in another; two with one prefix are equal or apart.
  if (address.is_v4()) {
    return std::ranges::any_of(v4_, [own = address.to_v4()](const ip::network_v4& network) {
      return ip::network_v4(own, network.prefix_length()).canonical() == network;
    });
  }
  // Without the interface that a link-local address comes with.
  return std::ranges::any_of(v6_, [own = ip::address_v6(address.to_v6().to_bytes())](const ip::network_v6& network) {
    return ip::network_v6(own, network.prefix_length()).canonical() == network;
  });
}

}  // namespace net
