#include "bridges/modbus/tcp_options.h"

#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

namespace modbus {
namespace {

using boost::asio::ip::tcp;

// Of data that is not acknowledged (TCP_USER_TIMEOUT); keepalive does not probe while there is any.
constexpr int kUnacknowledgedMilliseconds = 25'000;

// Of a line on which nothing is said: probes after 10, 15 and 20 s. With TCP_USER_TIMEOUT their number does not count,
// but that time (tcp_keepalive_timer()), so they begin early enough that one may be lost.
constexpr int kKeepaliveIdleSeconds = 10;
constexpr int kKeepaliveIntervalSeconds = 5;
constexpr int kKeepaliveProbes = 3;

void set_integer(tcp::socket& socket, int level, int option, int value) {
  // Where the kernel refuses one of these the connection works all the same.
  ::setsockopt(socket.native_handle(), level, option, &value, sizeof value);
}

// Sent by us and not acknowledged.
bool has_unacknowledged(tcp::socket& socket) {
  int count = 0;
  return ::ioctl(socket.native_handle(), SIOCOUTQ, &count) == 0 && count != 0;
}

bool has_some_on_its_way(tcp::socket& socket) {
  tcp_info info{};
  socklen_t size = sizeof info;
  return ::getsockopt(socket.native_handle(), IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || info.tcpi_unacked != 0;
}

}  // namespace

void prepare(tcp::socket& socket) {
  set_integer(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_integer(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPIDLE, kKeepaliveIdleSeconds);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPINTVL, kKeepaliveIntervalSeconds);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPCNT, kKeepaliveProbes);
  set_integer(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kUnacknowledgedMilliseconds);
}

void SlowReader::look(tcp::socket& socket) {
  if (!may_wait_) {
    return;
  }
  may_wait_ = has_unacknowledged(socket);
  const bool is_shut = may_wait_ && !has_some_on_its_way(socket);
  if (is_shut != spared_) {
    set_integer(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, is_shut ? 0 : kUnacknowledgedMilliseconds);
    spared_ = is_shut;
  }
}

}  // namespace modbus
