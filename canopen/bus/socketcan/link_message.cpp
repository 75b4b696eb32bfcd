#include "canopen/bus/socketcan/link_message.h"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>

#include <algorithm>

#include "canopen/bus/socketcan/netlink_bytes.h"

namespace canopen::socketcan {
namespace {

// <linux/if.h> has these as macros, but cannot stand beside <net/if.h>.
constexpr unsigned kLowerUp = 1U << 16;
constexpr unsigned kEcho = 1U << 18;

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

// IFLA_CAN_RESTART_MS comes without a bit rate too (an interface that was never set up).
std::optional<BitTiming> timing_of(Bytes can) {
  const auto bits = read_at<can_bittiming>(attribute(can, IFLA_CAN_BITTIMING));
  if (!bits || bits->bitrate == 0) {
    return std::nullopt;
  }
  return BitTiming{.bitrate = bits->bitrate,
                   .sample_point = static_cast<std::uint16_t>(std::min<std::uint32_t>(bits->sample_point, 1000)),
                   .restart_ms = read_at<std::uint32_t>(attribute(can, IFLA_CAN_RESTART_MS)).value_or(0)};
}

}  // namespace

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
  interface.timing = timing_of(can);
  return interface;
}

}  // namespace canopen::socketcan
