#include "canopen/bus/socketcan/raw_socket.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/sock_diag.h>
#include <poll.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>

namespace canopen::socketcan {
namespace {

// Changes of state, lost frames, frames that nobody acknowledged, and single errors of the wire, whose kinds tell what
// is wrong with it. The latter come where the driver tells of them (`berr-reporting`), at worst about as often as
// frames on a full bus; nothing is done about one but counting it.
constexpr can_err_mask_t kErrorClasses = CAN_ERR_CRTL | CAN_ERR_BUSOFF | CAN_ERR_RESTARTED | CAN_ERR_ACK | CAN_ERR_PROT;

// Raised by the kernel to its minimum, room for about six frames: what waits must wait in our own queue.
constexpr int kSendBuffer = 1;

bool set(int socket, int level, int option, int value) {
  return ::setsockopt(socket, level, option, &value, sizeof value) == 0;
}

bool set_options(int socket) {
  const can_err_mask_t errors = kErrorClasses;
  return set(socket, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, 1) &&
         ::setsockopt(socket, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) == 0 &&
         set(socket, SOL_SOCKET, SO_RXQ_OVFL, 1) && set(socket, SOL_SOCKET, SO_TIMESTAMPNS, 1) &&
         set(socket, SOL_SOCKET, SO_SNDBUF, kSendBuffer);
}

// SO_RCVBUFFORCE needs CAP_NET_ADMIN and ignores net.core.rmem_max; without it we get what that limit leaves.
int widen_receive_buffer(int socket) {
  if (!set(socket, SOL_SOCKET, SO_RCVBUFFORCE, kWantedReceiveBuffer)) {
    set(socket, SOL_SOCKET, SO_RCVBUF, kWantedReceiveBuffer);
  }
  int doubled = 0;
  socklen_t size = sizeof doubled;
  ::getsockopt(socket, SOL_SOCKET, SO_RCVBUF, &doubled, &size);
  return doubled / 2;
}

bool bind_to(int socket, int interface_index) {
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = interface_index;
  return ::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

RawSocket open_raw_socket(int interface_index) {
  RawSocket result;
  Descriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (socket.get() >= 0) {
    result.receive_buffer = widen_receive_buffer(socket.get());
    if (set_options(socket.get()) && bind_to(socket.get(), interface_index)) {
      result.descriptor = std::move(socket);
      return result;
    }
  }
  result.error = std::error_code(errno, std::generic_category());
  return result;
}

std::string small_buffer_notice(int receive_buffer) {
  if (receive_buffer >= kWantedReceiveBuffer) {
    return {};
  }
  return "receive buffer of " + std::to_string(receive_buffer) + " bytes instead of " +
         std::to_string(kWantedReceiveBuffer) +
         ": frames may be lost in bursts; raise it with sysctl net.core.rmem_max";
}

bool has_something_to_read(int socket) noexcept {
  pollfd poll{.fd = socket, .events = POLLIN, .revents = 0};
  return ::poll(&poll, 1, 0) > 0;
}

std::optional<std::uint32_t> dropped_so_far(int socket) noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  if (::getsockopt(socket, SOL_SOCKET, SO_MEMINFO, memory.data(), &size) != 0 ||
      size <= sizeof(memory[0]) * SK_MEMINFO_DROPS) {
    return std::nullopt;
  }
  return memory[SK_MEMINFO_DROPS];
}

}  // namespace canopen::socketcan
