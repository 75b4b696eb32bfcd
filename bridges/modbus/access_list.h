#pragma once

#include <boost/asio/ip/address.hpp>
#include <vector>

#include "config/model.h"

namespace modbus {

/// Address ranges. IPv4 ranges hold IPv4 addresses only, IPv6 ranges IPv6 only.
class AccessList {
 public:
  /// Throws std::runtime_error for what is no numeric address; `key` names the configuration key in its text.
  AccessList(const std::vector<config::Network>& networks, const char* key);

  [[nodiscard]] bool contains(const boost::asio::ip::address& address) const noexcept;

 private:
  struct Entry {
    boost::asio::ip::address address;
    unsigned prefix;
  };
  std::vector<Entry> entries_;
};

/// An IPv4 address that came in through an IPv6 socket (::ffff:192.0.2.7) as what it is.
[[nodiscard]] boost::asio::ip::address plain_address(const boost::asio::ip::address& address);

}  // namespace modbus
