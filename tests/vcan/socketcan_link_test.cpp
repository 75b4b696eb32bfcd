// As root: tests/vcan/run BUILD/tests/vcan/socketcan_link_test
#include "canopen/bus/socketcan/socketcan_link.h"

#include <gtest/gtest.h>

#include <array>
#include <optional>
#include <vector>

#include "tests/vcan/link_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;
using support::number_in;
using support::OtherSocket;
using support::shell;
using support::WithoutNetAdmin;

class SocketCanLinkTest : public support::LinkFixture {};

TEST_F(SocketCanLinkTest, OurFrameComesBackAsEchoAndIsSeenByOthers) {
  open_active();
  shell("timeout 10 candump -n 1 -L vcan0 >/tmp/socketcan_link_test.dump 2>&1 & sleep 0.3");
  EXPECT_EQ(link->send(frame(0x205, 7)), SendResult::handed_over);
  EXPECT_TRUE(events.echoes.empty()) << "told from inside send()";
  ASSERT_TRUE(run_until([&] { return !events.echoes.empty(); }));
  EXPECT_EQ(events.echoes, (std::vector<Frame>{frame(0x205, 7)}));
  EXPECT_TRUE(events.received.empty());
  shell("sleep 0.3; grep -q 'vcan0 205#07' /tmp/socketcan_link_test.dump");
}

TEST_F(SocketCanLinkTest, FramesOfOthersArriveWithTheKernelsStamp) {
  open_active();
  const WallTime before = wall_now();
  shell("cansend vcan0 185#8100");
  shell("cansend vcan0 705#R1");
  shell("cansend vcan0 1ABCDEF5#11");
  ASSERT_TRUE(run_until([&] { return events.received.size() == 3; }));
  EXPECT_EQ(events.received[0].frame, make_frame(0x185, std::array<std::uint8_t, 2>{0x81, 0}));
  EXPECT_TRUE(events.received[1].frame.remote);
  EXPECT_TRUE(events.received[2].frame.extended);
  EXPECT_EQ(events.received[2].frame.id, 0x1ABCDEF5U);
  for (const Received& received : events.received) {
    EXPECT_GE(received.wall, before);
    EXPECT_LE(received.wall, wall_now());
    EXPECT_LE(received.at, Clock::now());
  }
  EXPECT_LT(events.received[0].wall, events.received[2].wall);
  EXPECT_TRUE(events.echoes.empty());
}

TEST_F(SocketCanLinkTest, ABurstArrivesCompletelyInOrderAndInBatches) {
  open_active();
  OtherSocket other("vcan0");
  for (std::uint32_t i = 0; i < 2000; ++i) {
    other.send_number(i);
  }
  ASSERT_TRUE(run_until([&] { return events.received.size() == 2000; }));
  for (std::uint32_t i = 0; i < 2000; ++i) {
    ASSERT_EQ(number_in(events.received[i].frame), i);
  }
  EXPECT_GT(events.largest_batch, 16U);
  EXPECT_EQ(events.lost, 0U);
}

TEST_F(SocketCanLinkTest, EchoesKeepTheirPlaceAmongTheOthers) {
  open_active();
  OtherSocket other("vcan0");
  other.send_number(1);
  EXPECT_EQ(link->send(frame(0x205)), SendResult::handed_over);
  other.send_number(2);
  std::vector<std::size_t> received_at_echo;
  events.when_received = [&] { received_at_echo.push_back(events.echoes.size()); };
  ASSERT_TRUE(run_until([&] { return events.received.size() == 2; }));
  EXPECT_EQ(received_at_echo, (std::vector<std::size_t>{0, 1}));
}

// What waits behind the frame that is handled now was received, and is not delivered: an echo would be taken for
// missing.
TEST_F(SocketCanLinkTest, HeardIsNoMoreThanWasDelivered) {
  open_active();
  OtherSocket("vcan0").send_number(1);
  EXPECT_EQ(link->send(frame(0x205)), SendResult::handed_over);
  shell("sleep 0.05");
  const TimePoint long_after = Clock::now();
  std::optional<TimePoint> heard_until;
  events.when_received = [&] {
    EXPECT_TRUE(events.echoes.empty());
    heard_until = link->heard_until();
  };
  ASSERT_TRUE(run_until([&] { return !events.echoes.empty(); }));
  ASSERT_TRUE(heard_until);
  EXPECT_LT(*heard_until, long_after);
  EXPECT_GE(link->heard_until(), long_after) << "there is nothing more to deliver";
}

TEST_F(SocketCanLinkTest, DroppedFramesAreCountedExactly) {
  open_active();
  OtherSocket other("vcan0");
  constexpr std::uint32_t kFrames = 30000;
  for (std::uint32_t i = 0; i < kFrames; ++i) {
    other.send_number(i);
  }
  // The count comes with a frame that is received after the loss.
  ASSERT_TRUE(run_until([&] { return !events.received.empty(); }));
  run_for(500ms);
  other.send_number(kFrames);
  ASSERT_TRUE(run_until([&] { return number_in(events.received.back().frame) == kFrames; }));
  EXPECT_GT(events.lost, 0U);
  EXPECT_EQ(events.received.size() + events.lost, kFrames + 1);
  // About a second of a full bus at 1 Mbit/s fits.
  EXPECT_GT(events.received.size(), 7000U);
  EXPECT_TRUE(notices.empty() || notices.front().find("IFF_ECHO") != std::string::npos) << notices.front();
}

TEST_F(SocketCanLinkTest, ErrorFramesTellTheState) {
  open_active();
  OtherSocket other("vcan0");
  const auto expect_state = [&](BusState state) {
    ASSERT_TRUE(run_until([&] { return events.states.back() == state; }))
        << static_cast<int>(events.states.back().condition) << " instead of " << static_cast<int>(state.condition);
  };
  other.send_error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING, 96, 3);
  expect_state({BusCondition::warning, 96, 3});
  other.send_error(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE, 128, 3);
  expect_state({BusCondition::passive, 128, 3});
  other.send_error(CAN_ERR_BUSOFF, 0, 0, 0);
  expect_state({BusCondition::bus_off, 0, 0});
  other.send_error(CAN_ERR_RESTARTED, 0, 0, 0);
  expect_state({BusCondition::error_active, 0, 0});
  EXPECT_TRUE(events.received.empty()) << "an error frame is no frame";

  other.send_error(CAN_ERR_CRTL, CAN_ERR_CRTL_RX_OVERFLOW, 0, 0);
  ASSERT_TRUE(run_until([&] { return events.lost == 1; }));
}

TEST_F(SocketCanLinkTest, AnInterfaceThatGoesDownAndComesUp) {
  open_active();
  shell("ip link set vcan0 down");
  ASSERT_TRUE(run_until([&] { return events.is(BusCondition::down); }));
  EXPECT_EQ(link->send(frame(0x205)), SendResult::down);
  shell("ip link set vcan0 up");
  ASSERT_TRUE(run_until([&] { return events.is(BusCondition::error_active); }));
  EXPECT_EQ(link->send(frame(0x205)), SendResult::handed_over);
  shell("cansend vcan0 185#01");
  ASSERT_TRUE(run_until([&] { return !events.echoes.empty() && !events.received.empty(); }));
}

TEST_F(SocketCanLinkTest, AnInterfaceThatIsPulledAndPluggedAgain) {
  open_active();
  for (int round = 0; round < 3; ++round) {
    events.echoes.clear();
    events.received.clear();
    shell("ip link del vcan0");
    ASSERT_TRUE(run_until([&] { return events.is(BusCondition::down); }));
    EXPECT_EQ(link->send(frame(0x205)), SendResult::down);
    shell("ip link add vcan0 type vcan && ip link set vcan0 up");
    ASSERT_TRUE(run_until([&] { return events.is(BusCondition::error_active); }));
    EXPECT_EQ(link->send(frame(0x205)), SendResult::handed_over);
    shell("cansend vcan0 185#01");
    ASSERT_TRUE(run_until([&] { return !events.echoes.empty() && !events.received.empty(); }));
  }
}

TEST_F(SocketCanLinkTest, AnInterfaceThatWasReplacedUnseen) {
  open_active();
  shell("ip link del vcan0 && ip link add vcan0 type vcan && ip link set vcan0 up");
  ASSERT_TRUE(
      run_until([&] { return events.states.size() > 1 || link->send(frame(0x205)) == SendResult::handed_over; }));
  ASSERT_TRUE(run_until([&] { return events.is(BusCondition::error_active); }));
  shell("cansend vcan0 185#01");
  ASSERT_TRUE(run_until([&] { return !events.received.empty(); }));
}

TEST_F(SocketCanLinkTest, AMissingInterfaceIsWaitedFor) {
  open("vcan7");
  ASSERT_TRUE(run_until([&] { return events.is(BusCondition::down); }));
  EXPECT_EQ(link->send(frame(0x205)), SendResult::down);
  shell("ip link add vcan7 type vcan");
  run_for(200ms);
  EXPECT_TRUE(events.is(BusCondition::down)) << "there, but not up";
  shell("ip link set vcan7 up");
  ASSERT_TRUE(run_until([&] { return events.is(BusCondition::error_active); }));
  EXPECT_EQ(link->send(frame(0x205)), SendResult::handed_over);
  ASSERT_TRUE(run_until([&] { return !events.echoes.empty(); }));
  shell("ip link del vcan7");
}

TEST_F(SocketCanLinkTest, AnInterfaceThatIsNoCanIsSaidOnce) {
  open("lo");
  ASSERT_TRUE(run_until([&] { return events.is(BusCondition::down); }));
  run_for(2500ms);
  ASSERT_EQ(notices.size(), 1U);
  EXPECT_NE(notices.front().find("lo: no CAN socket"), std::string::npos) << notices.front();
}

TEST_F(SocketCanLinkTest, ASmallReceiveBufferIsSaid) {
  const WithoutNetAdmin unprivileged;
  open_active();
  ASSERT_FALSE(notices.empty());
  EXPECT_TRUE(notices.front().starts_with("vcan0: receive buffer of 212992 bytes")) << notices.front();
  EXPECT_NE(notices.front().find("net.core.rmem_max"), std::string::npos);
}

TEST_F(SocketCanLinkTest, AFullQueueIsBusyAndRecovers) {
  shell("ip link del vcan0 && ip link add vcan0 type vcan && ip link set vcan0 txqueuelen 2 up");
  shell("modprobe sch_tbf && tc qdisc replace dev vcan0 root tbf rate 8kbit burst 32 limit 64");
  open_active();
  int taken = 0;
  while (taken < 100 && link->send(frame(0x205, static_cast<std::uint8_t>(taken))) == SendResult::handed_over) {
    ++taken;
  }
  EXPECT_GT(taken, 0);
  EXPECT_LT(taken, 20) << "the kernel takes too many frames at once";
  ASSERT_TRUE(run_until([&] { return link->send(frame(0x206)) == SendResult::handed_over; }));
  shell("tc qdisc del dev vcan0 root");
}

TEST_F(SocketCanLinkTest, MayBeClosedFromInsideAnEvent) {
  open_active();
  OtherSocket other("vcan0");
  for (std::uint32_t i = 0; i < 100; ++i) {
    other.send_number(i);
  }
  other.send_error(CAN_ERR_BUSOFF, 0, 0, 0);
  events.when_received = [&] { link->close(); };
  ASSERT_TRUE(run_until([&] { return !events.received.empty(); }));
  const std::size_t received = events.received.size();
  const std::size_t states = events.states.size();
  run_for(300ms);
  EXPECT_EQ(events.received.size(), received);
  EXPECT_EQ(events.states.size(), states);
  EXPECT_EQ(link->send(frame(0x205)), SendResult::down);

  events.when_received = nullptr;
  link->open(events);
  ASSERT_TRUE(run_until([&] { return events.states.size() > states && events.is(BusCondition::error_active); }));
  other.send_number(1);
  ASSERT_TRUE(run_until([&] { return events.received.size() > received; }));
}

TEST_F(SocketCanLinkTest, OneTurnOfTheLoopIsBounded) {
  open_active();
  OtherSocket other("vcan0");
  for (std::uint32_t i = 0; i < 4000; ++i) {
    other.send_number(i);
  }
  std::size_t most = 0;
  while (events.received.size() < 4000) {
    const std::size_t before = events.received.size();
    ASSERT_GT(context.run_one_for(5s), 0U);
    most = std::max(most, events.received.size() - before);
  }
  EXPECT_LE(most, 512U);
}

}  // namespace
}  // namespace canopen
