#include "canopen/bus/socketcan/interface_query.h"

#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <span>

#include "canopen/bus/socketcan/netlink_bytes.h"

namespace canopen::socketcan {
namespace {

/// One request: header, interface message, name.
struct Request {
  nlmsghdr header{};
  ifinfomsg info{};
  rtattr attribute{};
  std::array<char, IFNAMSIZ> name{};
};

std::error_code error_of(int number) {
  return {number, std::generic_category()};
}

}  // namespace

InterfaceQuery::InterfaceQuery() : socket_(::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)) {
  if (socket_.get() < 0) {
    throw std::system_error(errno, std::generic_category(), "netlink socket for CAN interfaces");
  }
}

InterfaceQuery::Answer InterfaceQuery::ask(const std::string& name) {
  if (name.empty() || name.size() >= IFNAMSIZ) {
    return {};
  }
  Request request;
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.header.nlmsg_seq = ++sequence_;
  request.info.ifi_family = AF_UNSPEC;
  request.attribute.rta_type = IFLA_IFNAME;
  request.attribute.rta_len = RTA_LENGTH(IFNAMSIZ);
  std::copy(name.begin(), name.end(), request.name.begin());
  if (::send(socket_.get(), &request, sizeof request, 0) < 0) {
    return {.error = error_of(errno), .interface = {}};
  }

  // An answer may be one to an earlier request that failed on its way back.
  std::array<std::uint8_t, 16384> buffer;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled by the kernel
  for (;;) {
    const ssize_t size = ::recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (size < 0) {
      return {.error = error_of(errno), .interface = {}};
    }
    const Bytes bytes = Bytes(buffer).first(static_cast<std::size_t>(size));
    const auto header = read_at<nlmsghdr>(bytes);
    if (!header || header->nlmsg_seq != sequence_) {
      continue;
    }
    const Bytes message = bytes.subspan(std::min<std::size_t>(NLMSG_HDRLEN, bytes.size()));
    if (header->nlmsg_type == RTM_NEWLINK) {
      return {.error = {}, .interface = parse_link(message)};
    }
    const auto error = read_at<nlmsgerr>(message);
    if (error && error->error == -ENODEV) {
      return {};
    }
    return {.error = error_of(error && error->error < 0 ? -error->error : EPROTO), .interface = {}};
  }
}

}  // namespace canopen::socketcan
