#include "canopen/bus/socketcan/interface_bell.h"

#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace canopen::socketcan {

Descriptor open_interface_bell() {
  Descriptor socket(::socket(AF_NETLINK, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, NETLINK_ROUTE));
  sockaddr_nl address{};
  address.nl_family = AF_NETLINK;
  address.nl_groups = RTMGRP_LINK;
  if (socket.get() < 0 || ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    throw std::system_error(errno, std::generic_category(), "watching network interfaces over netlink");
  }
  return socket;
}

void silence_interface_bell(int socket) noexcept {
  // Truncated on purpose: nobody reads what is told. ENOBUFS is told once and stands for any number of changes.
  std::array<char, 16> buffer{};
  while (::recv(socket, buffer.data(), buffer.size(), MSG_DONTWAIT) >= 0 || errno == ENOBUFS || errno == EINTR) {
  }
}

}  // namespace canopen::socketcan
