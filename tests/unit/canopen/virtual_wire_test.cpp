// The in-process bus with a bit rate: frames take time, and the lowest identifier goes first.

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "canopen/bus/bus_load.h"
#include "canopen/bus/virtual_link.h"
#include "tests/support/frame.h"
#include "tests/support/hand_driven_loop.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;

constexpr std::uint32_t kWireBitrate = 125000;

class Station final : public LinkEvents {
 public:
  explicit Station(VirtualBus& bus) : link(bus.connect()) { link->open(*this); }
  void on_frames(std::span<const Received> frames) override {
    for (const Received& received : frames) {
      heard.push_back(received.frame);
      at.push_back(received.at);
    }
  }
  void on_echo(const Received& sent) override { echoes.emplace_back(sent.frame, sent.at); }
  void on_bus_state(const BusState& state) override { states.push_back(state.condition); }
  void on_frames_lost(std::uint32_t) override {}
  [[nodiscard]] SendResult send(const Frame& frame) { return link->send(frame); }

  std::unique_ptr<Link> link;
  std::vector<Frame> heard;
  std::vector<TimePoint> at;
  std::vector<std::pair<Frame, TimePoint>> echoes;
  std::vector<BusCondition> states;
};

class VirtualWireTest : public ::testing::Test {
 protected:
  static Duration time_of(const Frame& frame) {
    return std::chrono::nanoseconds(std::uint64_t{bits_on_wire(frame)} * std::nano::den / kWireBitrate);
  }
  static Frame full(std::uint32_t id) { return make_frame(id, std::array<std::uint8_t, 8>{1, 2, 3, 4, 5, 6, 7, 8}); }
  /// Lets the frame on the bus pass.
  void pass_one() {
    loop.settle();
    ASSERT_TRUE(bus.next_departure());
    loop.advance(*bus.next_departure() - Clock::now(), 1s);
  }

  support::HandDrivenLoop loop;
  VirtualBus bus{loop.executor(), kWireBitrate};
  Station a{bus};
  Station b{bus};
  Station c{bus};
};

TEST_F(VirtualWireTest, AFrameArrivesAndIsEchoedWhenItsLastBitHasPassed) {
  const TimePoint begun = Clock::now();
  EXPECT_EQ(a.send(full(0x205)), SendResult::handed_over);
  loop.settle();
  EXPECT_EQ(bus.next_departure(), begun + time_of(full(0x205)));
  loop.advance(time_of(full(0x205)) - 1us, 1us);
  EXPECT_TRUE(b.heard.empty());
  EXPECT_TRUE(a.echoes.empty());
  loop.advance(1us);
  EXPECT_EQ(b.heard, std::vector<Frame>{full(0x205)});
  EXPECT_EQ(c.at, std::vector<TimePoint>{begun + time_of(full(0x205))});
  ASSERT_EQ(a.echoes.size(), 1U);
  EXPECT_EQ(a.echoes[0], std::pair(full(0x205), begun + time_of(full(0x205))));
  EXPECT_TRUE(a.heard.empty());
  EXPECT_EQ(bus.next_departure(), std::nullopt);
}

TEST_F(VirtualWireTest, TheLowestIdentifierWinsWhateverTheOrderOfSending) {
  for (const std::uint32_t id : {0x705U, 0x185U}) {
    EXPECT_EQ(a.send(frame(id)), SendResult::handed_over);
  }
  EXPECT_EQ(b.send(frame(0x605)), SendResult::handed_over);
  pass_one();
  EXPECT_EQ(c.heard.back(), frame(0x605)) << "0x185 is not yet the first of its sender";
  pass_one();
  EXPECT_EQ(c.heard.back(), frame(0x705));
  pass_one();
  EXPECT_EQ(c.heard.back(), frame(0x185));
}

TEST_F(VirtualWireTest, AFrameOnTheBusIsNotBrokenOff) {
  EXPECT_EQ(a.send(frame(0x705)), SendResult::handed_over);
  loop.advance(100us, 100us);
  EXPECT_EQ(b.send(frame(0x080)), SendResult::handed_over);
  EXPECT_EQ(c.send(frame(0x000)), SendResult::handed_over);
  for (int i = 0; i < 3; ++i) {
    pass_one();
  }
  EXPECT_EQ(a.heard, (std::vector<Frame>{frame(0x000), frame(0x080)}));
  EXPECT_EQ(b.heard, (std::vector<Frame>{frame(0x705), frame(0x000)}));
}

TEST_F(VirtualWireTest, ADataFrameGoesBeforeARequestForIt) {
  Frame request = frame(0x705);
  request.remote = true;
  EXPECT_EQ(a.send(request), SendResult::handed_over);
  EXPECT_EQ(b.send(frame(0x705)), SendResult::handed_over);
  pass_one();
  EXPECT_EQ(c.heard.back(), frame(0x705));
  pass_one();
  EXPECT_EQ(c.heard.back(), request);
}

TEST_F(VirtualWireTest, AThousandFramesTakeTheTimeOfTheirBits) {
  const TimePoint begun = Clock::now();
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(a.send(full(0x205)), SendResult::handed_over);
  }
  while (a.echoes.size() < 1000) {
    pass_one();
  }
  EXPECT_EQ(Clock::now() - begun, 1000 * time_of(full(0x205)));
}

TEST_F(VirtualWireTest, AFrameStarvesAsLongAsOthersSendLowerIdentifiers) {
  EXPECT_EQ(b.send(full(0x181)), SendResult::handed_over);
  EXPECT_EQ(a.send(frame(0x77F)), SendResult::handed_over);
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(b.send(full(0x181)), SendResult::handed_over);
    pass_one();
  }
  EXPECT_TRUE(a.echoes.empty());
  pass_one();
  EXPECT_TRUE(a.echoes.empty());
  pass_one();
  EXPECT_EQ(a.echoes.size(), 1U);
}

TEST_F(VirtualWireTest, WhatWasUnderWayIsLostWhenTheBusGoesOff) {
  EXPECT_EQ(a.send(frame(0x205)), SendResult::handed_over);
  EXPECT_EQ(a.send(frame(0x206)), SendResult::handed_over);
  loop.advance(10us, 10us);
  bus.set_state({BusCondition::bus_off, 255, 0});
  EXPECT_EQ(bus.next_departure(), std::nullopt);
  EXPECT_EQ(a.send(frame(0x207)), SendResult::down);
  bus.set_state({BusCondition::error_active, 0, 0});
  loop.advance(1s);
  EXPECT_TRUE(b.heard.empty());
  EXPECT_TRUE(a.echoes.empty());
  EXPECT_EQ(a.send(frame(0x208)), SendResult::handed_over);
  pass_one();
  EXPECT_EQ(b.heard, std::vector<Frame>{frame(0x208)});
}

TEST_F(VirtualWireTest, EachLinkHasAQueueThatIsBounded) {
  for (std::size_t i = 0; i < VirtualBus::kCapacity; ++i) {
    ASSERT_EQ(a.send(frame(0x205)), SendResult::handed_over);
  }
  EXPECT_EQ(a.send(frame(0x205)), SendResult::busy);
  EXPECT_EQ(b.send(frame(0x205)), SendResult::handed_over);
}

TEST_F(VirtualWireTest, TheFrameOfALinkThatIsUnpluggedPassesAndWhatItHeldIsGone) {
  EXPECT_EQ(a.send(frame(0x205)), SendResult::handed_over);
  EXPECT_EQ(a.send(frame(0x206)), SendResult::handed_over);
  loop.settle();
  a.link.reset();
  loop.advance(1s);
  EXPECT_EQ(b.heard, std::vector<Frame>{frame(0x205)});
}

}  // namespace
}  // namespace canopen
