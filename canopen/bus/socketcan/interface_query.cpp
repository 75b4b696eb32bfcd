#include "canopen/bus/socketcan/interface_query.h"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>

namespace canopen::socketcan {
namespace {

// <linux/if.h> has these as macros, but cannot stand beside <net/if.h>.
constexpr unsigned kLowerUp = 1U << 16;
constexpr unsigned kEcho = 1U << 18;

using Bytes = std::span<const std::uint8_t>;

// Netlink pads everything to four bytes, in the sender's own byte order; so every structure is copied out.
template <class T>
std::optional<T> read_at(Bytes bytes, std::size_t offset = 0) {
  T value{};
  if (bytes.size() < offset + sizeof value) {
    return std::nullopt;
  }
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// The content of the attribute `type` among `attributes`; empty where there is none.
Bytes attribute(Bytes attributes, unsigned type) {
  while (const auto header = read_at<rtattr>(attributes)) {
    if (header->rta_len < sizeof(rtattr) || header->rta_len > attributes.size()) {
      return {};
    }
    if ((header->rta_type & NLA_TYPE_MASK) == type) {
      return attributes.first(header->rta_len).subspan(RTA_LENGTH(0));
    }
    attributes = attributes.subspan(std::min<std::size_t>(RTA_ALIGN(header->rta_len), attributes.size()));
  }
  return {};
}

std::optional<BusCondition> condition_of(std::uint32_t state) {
  switch (state) {
    case CAN_STATE_ERROR_ACTIVE:
      return BusCondition::error_active;
    case CAN_STATE_ERROR_WARNING:
      return BusCondition::warning;
    case CAN_STATE_ERROR_PASSIVE:
      return BusCondition::passive;
    case CAN_STATE_BUS_OFF:
      return BusCondition::bus_off;
    case CAN_STATE_STOPPED:
    case CAN_STATE_SLEEPING:
      return BusCondition::down;
    default:
      return std::nullopt;
  }
}

std::optional<Interface> parse_link(Bytes message) {
  const auto info = read_at<ifinfomsg>(message);
  if (!info) {
    return std::nullopt;
  }
  Interface interface;
  interface.index = info->ifi_index;
  interface.administratively_up = (info->ifi_flags & IFF_UP) != 0;
  interface.carrier = (info->ifi_flags & kLowerUp) != 0;
  interface.echoes = (info->ifi_flags & kEcho) != 0;
  const Bytes attributes = message.subspan(std::min<std::size_t>(NLMSG_ALIGN(sizeof(ifinfomsg)), message.size()));
  const Bytes can = attribute(attribute(attributes, IFLA_LINKINFO), IFLA_INFO_DATA);
  if (const auto state = read_at<std::uint32_t>(attribute(can, IFLA_CAN_STATE))) {
    interface.condition = condition_of(*state);
  }
  if (const auto counters = read_at<can_berr_counter>(attribute(can, IFLA_CAN_BERR_COUNTER))) {
    interface.counters = Interface::Counters{counters->txerr, counters->rxerr};
  }
  return interface;
}

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
