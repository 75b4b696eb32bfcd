#include "bridges/modbus/access_list.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>

namespace modbus {
namespace {

template <std::size_t Size>
bool same_prefix(const std::array<unsigned char, Size>& one, const std::array<unsigned char, Size>& other,
                 unsigned prefix) noexcept {
  const unsigned bits = std::min<unsigned>(prefix, 8 * Size);
  const std::size_t whole = bits / 8;
  if (!std::equal(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(whole), other.begin())) {
    return false;
  }
  const unsigned rest = bits % 8;
  return rest == 0 || (one[whole] ^ other[whole]) >> (8 - rest) == 0;
}

}  // namespace

boost::asio::ip::address plain_address(const boost::asio::ip::address& address) {
  if (address.is_v6() && address.to_v6().is_v4_mapped()) {
    return boost::asio::ip::make_address_v4(boost::asio::ip::v4_mapped, address.to_v6());
  }
  return address;
}

AccessList::AccessList(const std::vector<config::Network>& networks, const char* key) {
  for (const config::Network& network : networks) {
    boost::system::error_code failed;
    const auto address = boost::asio::ip::make_address(network.address, failed);
    if (failed) {
      throw std::runtime_error(std::string(key) + ": \"" + network.address +
                               "\" is no numeric address; write it as 192.0.2.0/24 or 2001:db8::/32");
    }
    entries_.push_back({.address = address, .prefix = network.prefix});
  }
}

bool AccessList::contains(const boost::asio::ip::address& address) const noexcept {
  return std::ranges::any_of(entries_, [&address](const Entry& entry) {
    if (address.is_v4() != entry.address.is_v4()) {
      return false;
    }
    return address.is_v4() ? same_prefix(address.to_v4().to_bytes(), entry.address.to_v4().to_bytes(), entry.prefix)
                           : same_prefix(address.to_v6().to_bytes(), entry.address.to_v6().to_bytes(), entry.prefix);
  });
}

}  // namespace modbus
