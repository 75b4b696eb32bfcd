#include "bridges/net/tcp_options.h"

#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include "bridges/net/tcp_state.h"

namespace net {
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

}  // namespace

void prepare(tcp::socket& socket) {
  set_integer(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_integer(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPIDLE, kKeepaliveIdleSeconds);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPINTVL, kKeepaliveIntervalSeconds);
  set_integer(socket, IPPROTO_TCP, TCP_KEEPCNT, kKeepaliveProbes);
  set_integer(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, kUnacknowledgedMilliseconds);
}

canopen::Duration silence(tcp::socket& socket) {
  return milliseconds_since_received(socket.native_handle()).value_or(std::chrono::milliseconds(0));
}

void SlowReader::look(tcp::socket& socket) {
  if (!may_wait_) {
    return;
  }
  may_wait_ = has_unacknowledged(socket);
  const bool is_shut = may_wait_ && has_shut_window(socket.native_handle());
  if (is_shut != spared_) {
    set_integer(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, is_shut ? 0 : kUnacknowledgedMilliseconds);
    spared_ = is_shut;
  }
}

}  // namespace net
