#pragma once

#include <boost/asio/ip/address.hpp>
#include <boost/asio/ip/network_v4.hpp>
#include <boost/asio/ip/network_v6.hpp>
#include <vector>

#include "config/model.h"

namespace net {

/// Address ranges. IPv4 ranges hold IPv4 addresses only, IPv6 ranges IPv6 only.
class AccessList {
 public:
  /// Throws std::runtime_error for what is no network; `key` names the configuration key in its text.
  AccessList(const std::vector<config::Network>& networks, const char* key);

  /// `address` is a plain one, see below.
  [[nodiscard]] bool contains(const boost::asio::ip::address& address) const noexcept;

 private:
  std::vector<boost::asio::ip::network_v4> v4_;
  std::vector<boost::asio::ip::network_v6> v6_;
};

/// An IPv4 address that came in through an IPv6 socket (::ffff:192.0.2.7) as what it is.
[[nodiscard]] boost::asio::ip::address plain_address(const boost::asio::ip::address& address);

}  // namespace net
