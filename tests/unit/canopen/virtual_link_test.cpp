#include "canopen/bus/virtual_link.h"

#include <gtest/gtest.h>

#include <array>

#include "tests/support/frame.h"
#include "tests/support/hand_driven_loop.h"

namespace canopen {
namespace {

using support::frame;

class Plug final : public LinkEvents {
 public:
  explicit Plug(VirtualBus& bus) : link(bus.connect()) { link->open(*this); }
  void on_frames(std::span<const Received> frames) override {
    for (const Received& received : frames) {
      heard.push_back(received.frame);
      times.push_back(received.at);
      if (when_heard) {
        when_heard();
      }
    }
  }
  void on_echo(const Received& sent) override { echoes.push_back(sent.frame); }
  void on_bus_state(const BusState& state) override { states.push_back(state.condition); }
  void on_frames_lost(std::uint32_t) override {}

  std::unique_ptr<Link> link;
  std::vector<Frame> heard;
  std::vector<TimePoint> times;
  std::vector<Frame> echoes;
  std::vector<BusCondition> states;
  std::function<void()> when_heard;
};

class VirtualLinkTest : public ::testing::Test {
 protected:
  support::HandDrivenLoop loop;
  VirtualBus bus{loop.executor()};
  Plug a{bus};
  Plug b{bus};
};

TEST_F(VirtualLinkTest, FramesReachTheOthersInOrderAndComeBackAsEchoes) {
  Plug c{bus};
  EXPECT_EQ(a.link->send(frame(0x205, 1)), SendResult::handed_over);
  EXPECT_EQ(a.link->send(frame(0x101, 2)), SendResult::handed_over);
  EXPECT_TRUE(b.heard.empty()) << "delivered from inside send()";
  loop.settle();
  const std::vector<Frame> both{frame(0x205, 1), frame(0x101, 2)};
  EXPECT_EQ(b.heard, both);
  EXPECT_EQ(c.heard, both);
  EXPECT_EQ(a.echoes, both);
  EXPECT_TRUE(a.heard.empty());
  EXPECT_EQ(b.times.front(), Clock::now());
}

TEST_F(VirtualLinkTest, EveryLinkLearnsTheState) {
  loop.settle();
  bus.set_state({BusCondition::down, 0, 0});
  loop.settle();
  EXPECT_EQ(a.states, (std::vector<BusCondition>{BusCondition::error_active, BusCondition::down}));
  EXPECT_EQ(b.states, a.states);
  EXPECT_EQ(a.link->send(frame(0x205)), SendResult::down);
}

TEST_F(VirtualLinkTest, WhatWasUnderWayIsLostWhenTheBusGoesOff) {
  EXPECT_EQ(a.link->send(frame(0x205)), SendResult::handed_over);
  bus.set_state({BusCondition::bus_off, 255, 0});
  bus.set_state({BusCondition::error_active, 0, 0});
  loop.settle();
  EXPECT_TRUE(b.heard.empty());
  EXPECT_TRUE(a.echoes.empty());
}

TEST_F(VirtualLinkTest, IsBounded) {
  for (std::size_t i = 0; i < VirtualBus::kCapacity; ++i) {
    ASSERT_EQ(a.link->send(frame(0x205)), SendResult::handed_over);
  }
  EXPECT_EQ(a.link->send(frame(0x205)), SendResult::busy);
  loop.settle();
  EXPECT_EQ(b.heard.size(), VirtualBus::kCapacity);
  EXPECT_EQ(a.link->send(frame(0x205)), SendResult::handed_over);
}

TEST_F(VirtualLinkTest, EchoesMayBeWithheld) {
  bus.withhold_echoes(true);
  EXPECT_EQ(a.link->send(frame(0x205)), SendResult::handed_over);
  loop.settle();
  EXPECT_EQ(b.heard.size(), 1U);
  EXPECT_TRUE(a.echoes.empty());
}

TEST_F(VirtualLinkTest, AClosedLinkHearsNothing) {
  loop.settle();
  EXPECT_EQ(a.link->send(frame(0x205)), SendResult::handed_over);
  bus.set_state({BusCondition::warning, 96, 0});
  b.link->close();
  b.states.clear();
  loop.settle();
  EXPECT_TRUE(b.heard.empty());
  EXPECT_TRUE(b.states.empty());
}

TEST_F(VirtualLinkTest, AReceiverMayUnplugItself) {
  Plug c{bus};
  b.when_heard = [&] { b.link.reset(); };
  EXPECT_EQ(a.link->send(frame(0x205, 1)), SendResult::handed_over);
  EXPECT_EQ(a.link->send(frame(0x205, 2)), SendResult::handed_over);
  loop.settle();
  EXPECT_EQ(b.heard.size(), 1U);
  EXPECT_EQ(c.heard.size(), 2U);
}

TEST_F(VirtualLinkTest, ASenderMayBeGoneBeforeItsFrameArrives) {
  EXPECT_EQ(a.link->send(frame(0x205)), SendResult::handed_over);
  a.link.reset();
  loop.settle();
  EXPECT_EQ(b.heard.size(), 1U);
}

}  // namespace
}  // namespace canopen
