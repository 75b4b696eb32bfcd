#include "bridges/net/privileged_port.h"

#include <boost/asio/ip/address.hpp>
#include <boost/system/error_code.hpp>

namespace net {
namespace {

// ListenStream= of systemd/canopen-gateway.socket.
constexpr const char* kPackaged = "0.0.0.0:502";

bool is_numeric(const std::string& host) {
  boost::system::error_code failed;
  static_cast<void>(boost::asio::ip::make_address(host, failed));
  return !failed;
}

}  // namespace

std::string text_of(const config::Endpoint& entry) {
  const bool is_v6 = entry.host.find(':') != std::string::npos;
  return (is_v6 ? "[" + entry.host + "]" : entry.host) + ":" + std::to_string(entry.port);
}

std::string privileged_port_remedy(const config::Endpoint& entry, bool may_be_passed) {
  const std::string at = text_of(entry);
  const std::string way_out = "or take a port from 1024 on";
  if (!may_be_passed) {
    return "the service has no privilege for ports below 1024: take another, or give it that by the drop-in "
           "privileged-port.conf";
  }
  if (!is_numeric(entry.host)) {
    return "systemd opens ports below 1024 for the service, and passes them to entries with a numeric address only: "
           "write one for " +
           entry.host + ", " + way_out;
  }
  if (at == kPackaged) {
    return "systemd opens this port for the service: `systemctl enable canopen-gateway.socket`, then restart; where "
           "it is enabled and was edited, add ListenStream=" +
           at + " to it; " + way_out;
  }
  return std::string("systemd opens ports below 1024 for the service, and canopen-gateway.socket has ") + kPackaged +
         ": write that in `listen`; or let `systemctl edit canopen-gateway.socket` say [Socket], ListenStream= (with "
         "nothing behind it), ListenStream=" +
         at +
         ", each in a line, and one more for each other entry of `listen` below 1024, then `systemctl enable "
         "canopen-gateway.socket` and restart; " +
         way_out;
}

}  // namespace net
