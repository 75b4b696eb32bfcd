#include "simulator/network.h"

#include <gtest/gtest.h>

#include <deque>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

/// A link whose answers the test chooses.
class ScriptedLink final : public canopen::Link {
 public:
  void open(canopen::LinkEvents& owner) override { events = &owner; }
  void close() override { events = nullptr; }
  canopen::SendResult send(const canopen::Frame& frame) override {
    if (result == canopen::SendResult::handed_over) {
      sent.push_back(frame);
    }
    return result;
  }

  canopen::LinkEvents* events = nullptr;
  canopen::SendResult result = canopen::SendResult::handed_over;
  std::vector<canopen::Frame> sent;
};

class NetworkTest : public ::testing::Test {
 protected:
  NetworkTest() {
    auto owned = std::make_unique<ScriptedLink>();
    link = owned.get();
    network = std::make_unique<Network>(loop.executor(), std::move(owned));
    network->open();
  }

  support::HandDrivenLoop loop;
  ScriptedLink* link = nullptr;
  std::unique_ptr<Network> network;
};

TEST_F(NetworkTest, BusyFramesWaitAndLeaveInOrder) {
  link->result = canopen::SendResult::busy;
  for (std::uint8_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(network->send(frame(0x100U + i, {i})));
  }
  EXPECT_EQ(network->frames_waiting(), 3U);
  loop.advance(milliseconds(5));
  EXPECT_TRUE(link->sent.empty());
  link->result = canopen::SendResult::handed_over;
  loop.advance(milliseconds(1));
  ASSERT_EQ(link->sent.size(), 3U);
  EXPECT_EQ(link->sent[0].id, 0x100U);
  EXPECT_EQ(link->sent[2].id, 0x102U);
  EXPECT_EQ(network->frames_lost(), 0U);
}

TEST_F(NetworkTest, TheQueueIsBounded) {
  link->result = canopen::SendResult::busy;
  for (std::size_t i = 0; i < Network::kCapacity; ++i) {
    ASSERT_TRUE(network->send(frame(0x100, {})));
  }
  EXPECT_FALSE(network->send(frame(0x100, {})));
  EXPECT_EQ(network->frames_lost(), 1U);
  EXPECT_EQ(network->frames_waiting(), Network::kCapacity);
}

TEST_F(NetworkTest, ABusThatGoesDownLosesWhatWaits) {
  link->result = canopen::SendResult::busy;
  EXPECT_TRUE(network->send(frame(0x100, {})));
  link->events->on_bus_state({canopen::BusCondition::bus_off, 0, 0});
  EXPECT_EQ(network->frames_waiting(), 0U);
  EXPECT_EQ(network->frames_lost(), 1U);
  link->result = canopen::SendResult::down;
  EXPECT_FALSE(network->send(frame(0x100, {})));
}

TEST_F(NetworkTest, ABootUpOfADeadBusLeavesWhenItComesBack) {
  link->result = canopen::SendResult::down;
  const auto drive = make_drive("veichi-ac300", 9, *network);
  drive->power_on();
  loop.advance(milliseconds(100));
  EXPECT_TRUE(link->sent.empty());
  link->result = canopen::SendResult::handed_over;
  link->events->on_bus_state({canopen::BusCondition::error_active, 0, 0});
  EXPECT_EQ(link->sent, std::vector{frame(0x709, {0})});
  link->events->on_bus_state({canopen::BusCondition::down, 0, 0});
  link->events->on_bus_state({canopen::BusCondition::error_active, 0, 0});
  EXPECT_EQ(link->sent.size(), 1U);
}

TEST_F(NetworkTest, NothingLeavesAfterClose) {
  network->close();
  EXPECT_FALSE(network->send(frame(0x100, {})));
  EXPECT_TRUE(link->sent.empty());
  network->open();
  EXPECT_TRUE(network->send(frame(0x100, {})));
}

TEST(NetworkOfDrives, DrivesOnOneLinkHearOneAnother) {
  Bench bench;
  DriveOptions options;
  options.heartbeat_ms = 50;
  const auto producer = make_drive("veichi-ac300", 7, bench.network, options);
  const auto consumer = make_drive("cia402-velocity", 8, bench.network);
  producer->power_on();
  consumer->power_on();
  ASSERT_EQ(bench.write(8, 0x1016, 1, 7U << 16U | 200U, 4), 0U);
  bench.advance(milliseconds(500));
  EXPECT_TRUE(bench.take(0x088).empty());
  producer->power_off();
  bench.advance(milliseconds(250));
  EXPECT_EQ(bench.take(0x088).size(), 1U);
}

TEST(NetworkOfDrives, EveryDriveAnswersForItself) {
  Bench bench;
  std::vector<std::unique_ptr<Drive>> drives;
  for (std::uint8_t node = 1; node <= 64; ++node) {
    drives.push_back(make_drive(node % 2 == 0 ? "vacon-opte6" : "invt-goodrive600", node, bench.network));
    drives.back()->power_on();
  }
  bench.loop.settle();
  for (std::uint8_t node = 1; node <= 64; ++node) {
    EXPECT_EQ(bench.take(0x700U + node).size(), 1U);
    EXPECT_EQ(bench.read(node, 0x1000, 0), node % 2 == 0 ? 0x00010192U : 0U);
  }
  drives.erase(drives.begin());
  bench.nmt(0x01, 0);
  EXPECT_EQ(drives[0]->state(), NmtState::operational);
}

}  // namespace
}  // namespace simulator
