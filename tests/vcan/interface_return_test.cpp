// As root: tests/vcan/run BUILD/tests/vcan/socketcan_link_test
// Interfaces that go and come back, under traffic.
#include <gtest/gtest.h>
#include <linux/can.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "canopen/bus/socketcan/descriptor.h"
#include "tests/vcan/link_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;
using support::OtherSocket;
using support::shell;

/// A node that goes on sending whatever becomes of the interface.
class Traffic {
 public:
  explicit Traffic(std::string interface)
      : thread_([this, name = std::move(interface)] {
          while (!stop_) {
            send(name);
            std::this_thread::sleep_for(10ms);
          }
        }) {}
  ~Traffic() {
    stop_ = true;
    thread_.join();
  }
  Traffic(const Traffic&) = delete;
  Traffic& operator=(const Traffic&) = delete;

 private:
  static void send(const std::string& interface) {
    const socketcan::Descriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW));
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    can_frame heartbeat{};
    heartbeat.can_id = 0x705;
    heartbeat.can_dlc = 1;
    // Where the interface is away it goes nowhere.
    if (address.can_ifindex != 0 &&
        ::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
      [[maybe_unused]] const ssize_t written = ::write(socket.get(), &heartbeat, sizeof heartbeat);
    }
  }

  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

class InterfaceReturnTest : public support::LinkFixture {
 protected:
  static constexpr auto kCreate = "ip link add vcan5 index 77 type vcan && ip link set vcan5 up";
  static constexpr auto kUp = "ip link set vcan5 up";

  void SetUp() override {
    shell("modprobe vcan 2>/dev/null; ip link del vcan5 2>/dev/null; ip netns del away 2>/dev/null; ip netns add away");
    shell(kCreate);
    open("vcan5");
    ASSERT_TRUE(run_until([this] { return events.is(BusCondition::error_active); }));
  }
  void TearDown() override {
    link.reset();
    shell("ip netns del away; ip link del vcan5 2>/dev/null; true");
  }

  static void move_away() { shell("ip link set vcan5 netns away"); }
  static void move_back() {
    shell("ip -n away link set vcan5 netns " + std::to_string(::getpid()));
    shell(kUp);
  }
  static void expect_same_index() { EXPECT_EQ(::if_nametoindex("vcan5"), 77U); }

  void forget() {
    events.received.clear();
    events.echoes.clear();
    events.states.clear();
  }
  /// Frames and echoes come within two seconds, and the bus was told to be down meanwhile.
  void expect_served_again() {
    const auto begun = std::chrono::steady_clock::now();
    const auto tries_to_send = [this] {
      if (events.is(BusCondition::error_active) && events.echoes.empty()) {
        static_cast<void>(link->send(frame(0x77F, 5)));
      }
      return events.is(BusCondition::error_active) && !events.echoes.empty() && !events.received.empty();
    };
    ASSERT_TRUE(run_until(tries_to_send)) << events.received.size() << " frames, " << events.echoes.size() << " echoes";
    const auto took = std::chrono::steady_clock::now() - begun;
    EXPECT_LT(took, 2s);
    RecordProperty("served_again_ms", static_cast<int>(took / 1ms));
    EXPECT_EQ(events.states.front().condition, BusCondition::down);
  }
  void expect_down() {
    ASSERT_TRUE(run_until([this] { return events.is(BusCondition::down); }));
    EXPECT_EQ(link->send(frame(0x77F, 5)), SendResult::down);
  }
};

TEST_F(InterfaceReturnTest, DownAndUp) {
  const Traffic traffic("vcan5");
  forget();
  shell("ip link set vcan5 down");
  expect_down();
  events.received.clear();
  shell(kUp);
  expect_served_again();
}

TEST_F(InterfaceReturnTest, DeletedAndCreatedAgainWithItsIndex) {
  const Traffic traffic("vcan5");
  forget();
  shell("ip link del vcan5");
  expect_down();
  events.received.clear();
  shell(kCreate);
  expect_served_again();
  expect_same_index();
}

TEST_F(InterfaceReturnTest, DeletedAndCreatedAgainWithItsIndexWhileNobodyLooked) {
  const Traffic traffic("vcan5");
  forget();
  shell("ip link del vcan5");
  shell(kCreate);
  expect_served_again();
  expect_same_index();
}

TEST_F(InterfaceReturnTest, MovedToAnotherNamespaceAndBack) {
  const Traffic traffic("vcan5");
  forget();
  move_away();
  expect_down();
  events.received.clear();
  move_back();
  expect_served_again();
  expect_same_index();
}

TEST_F(InterfaceReturnTest, MovedToAnotherNamespaceAndBackWhileNobodyLooked) {
  const Traffic traffic("vcan5");
  forget();
  move_away();
  move_back();
  expect_served_again();
  expect_same_index();
}

// The error that the socket holds is told once, and here to send().
TEST_F(InterfaceReturnTest, WhereOnlySendingShowsItTheSocketIsDroppedToo) {
  forget();
  shell("ip link del vcan5");
  shell(kCreate);
  static_cast<void>(link->send(frame(0x77F, 5)));
  static_cast<void>(link->send(frame(0x77F, 5)));
  const Traffic traffic("vcan5");
  expect_served_again();
}

TEST_F(InterfaceReturnTest, WhatWaitedWhenItWentDownIsNeverDelivered) {
  forget();
  {
    OtherSocket other("vcan5");
    other.send(0x705, {5});
    other.send(0x705, {5});
  }
  shell("ip link set vcan5 down");
  expect_down();
  EXPECT_TRUE(events.received.empty());
  shell(kUp);
  ASSERT_TRUE(run_until([this] { return events.is(BusCondition::error_active); }));
  OtherSocket("vcan5").send(0x706, {5});
  ASSERT_TRUE(run_until([this] { return !events.received.empty(); }));
  EXPECT_EQ(events.received.front().frame.id, 0x706U);
}

TEST_F(InterfaceReturnTest, LimitsAreToldOncePerAppearance) {
  const std::size_t told = notices.size();
  EXPECT_GT(told, 0U) << "vcan proves no departure";
  shell("ip link set vcan5 down");
  expect_down();
  shell(kUp);
  ASSERT_TRUE(run_until([this] { return events.is(BusCondition::error_active); }));
  EXPECT_EQ(notices.size(), told);
}

}  // namespace
}  // namespace canopen
