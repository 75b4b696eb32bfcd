#include "bridges/net/tcp_state.h"

#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstddef>

namespace net {
namespace {

struct Known {
  tcp_info info{};
  socklen_t size = 0;  ///< Older kernels tell less.
};

Known ask(int socket) {
  Known known;
  known.size = sizeof known.info;
  if (::getsockopt(socket, IPPROTO_TCP, TCP_INFO, &known.info, &known.size) != 0) {
    known.size = 0;
  }
  return known;
}

}  // namespace

std::optional<std::chrono::milliseconds> milliseconds_since_received(int socket) {
  const Known known = ask(socket);
  if (known.size < offsetof(tcp_info, tcpi_last_data_recv) + sizeof known.info.tcpi_last_data_recv) {
    return std::nullopt;
  }
  return std::chrono::milliseconds(known.info.tcpi_last_data_recv);
}

bool has_shut_window(int socket) {
  const Known known = ask(socket);
  return known.size >= offsetof(tcp_info, tcpi_snd_wnd) + sizeof known.info.tcpi_snd_wnd &&
         known.info.tcpi_snd_wnd == 0;
}

}  // namespace net
