// What the kernel answers to RTM_GETLINK, laid out as linux/rtnetlink.h and linux/can/netlink.h say.
#include "canopen/bus/socketcan/link_message.h"

#include <gtest/gtest.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>

#include <cstring>
#include <vector>

namespace canopen::socketcan {
namespace {

using Message = std::vector<std::uint8_t>;

template <class T>
Message bytes_of(const T& value) {
  Message bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

Message padded(Message bytes) {
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

Message operator+(Message a, const Message& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Message attribute(unsigned short type, const Message& content) {
  const rtattr header{static_cast<unsigned short>(sizeof(rtattr) + content.size()), type};
  return padded(bytes_of(header) + content);
}

Message text(const char* content) {
  return Message(content, content + std::strlen(content) + 1);
}

Message link(const Message& can, unsigned flags = IFF_UP | IFF_RUNNING | (1U << 16)) {
  ifinfomsg info{};
  info.ifi_index = 7;
  info.ifi_flags = flags;
  return bytes_of(info) + attribute(IFLA_IFNAME, text("can0")) +
         attribute(IFLA_LINKINFO, attribute(IFLA_INFO_KIND, text("can")) + attribute(IFLA_INFO_DATA, can));
}

Message timing(std::uint32_t bitrate, std::uint32_t sample_point) {
  can_bittiming bits{};
  bits.bitrate = bitrate;
  bits.sample_point = sample_point;
  return attribute(IFLA_CAN_BITTIMING, bytes_of(bits));
}

TEST(LinkMessage, AControllerTellsAllOfIt) {
  const auto interface = parse_link(
      link(timing(250'000, 875) + attribute(IFLA_CAN_STATE, bytes_of<std::uint32_t>(CAN_STATE_ERROR_PASSIVE)) +
           attribute(IFLA_CAN_RESTART_MS, bytes_of<std::uint32_t>(100)) +
           attribute(IFLA_CAN_BERR_COUNTER, bytes_of(can_berr_counter{.txerr = 128, .rxerr = 3}))));
  ASSERT_TRUE(interface);
  EXPECT_EQ(interface->index, 7);
  EXPECT_TRUE(interface->administratively_up);
  EXPECT_TRUE(interface->carrier);
  EXPECT_FALSE(interface->echoes);
  EXPECT_EQ(interface->condition, BusCondition::passive);
  ASSERT_TRUE(interface->counters);
  EXPECT_EQ(interface->counters->transmit, 128);
  EXPECT_EQ(interface->counters->receive, 3);
  EXPECT_EQ(interface->timing, (BitTiming{.bitrate = 250'000, .sample_point = 875, .restart_ms = 100}));
}

TEST(LinkMessage, OneThatWasNeverSetUpHasNoTiming) {
  const auto interface =
      parse_link(link(timing(0, 0) + attribute(IFLA_CAN_RESTART_MS, bytes_of<std::uint32_t>(100)), 0));
  ASSERT_TRUE(interface);
  EXPECT_FALSE(interface->administratively_up);
  EXPECT_FALSE(interface->timing);
  EXPECT_FALSE(interface->condition);
}

TEST(LinkMessage, WhatIsCutOffIsLeftOut) {
  const Message whole = link(timing(250'000, 875) + attribute(IFLA_CAN_RESTART_MS, bytes_of<std::uint32_t>(100)));
  ASSERT_TRUE(parse_link(whole)->timing);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const auto interface = parse_link(std::span(whole).first(size));
    EXPECT_EQ(interface.has_value(), size >= sizeof(ifinfomsg));
    EXPECT_FALSE(interface && interface->timing) << size;
  }
}

TEST(LinkMessage, AnAttributeOfNoLengthEndsTheSearch) {
  EXPECT_FALSE(parse_link(link(Message(8)))->timing);
}

}  // namespace
}  // namespace canopen::socketcan
