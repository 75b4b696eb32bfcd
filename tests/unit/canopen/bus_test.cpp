#include "canopen/bus/bus.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "tests/support/bus_fixture.h"
#include "tests/support/spawn.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;
using support::HandLink;
using support::kQuiet;

class BusTest : public support::BusFixture {};

TEST_F(BusTest, FramesReachThoseWhoSubscribed) {
  const auto bus = start(kQuiet);
  std::vector<std::uint8_t> contents;
  const Subscription first = bus->subscribe(0x185, [&](const Received& r) { contents.push_back(r.frame.data[0]); });
  const Subscription second = bus->subscribe(0x185, [&](const Received& r) { contents.push_back(r.frame.data[0]); });
  EXPECT_EQ(other.link->send(frame(0x185, 7)), SendResult::handed_over);
  EXPECT_EQ(other.link->send(frame(0x186, 8)), SendResult::handed_over);
  loop.settle();
  EXPECT_EQ(contents, (std::vector<std::uint8_t>{7, 7}));
  EXPECT_EQ(bus->statistics().frames_received, 2U);
}

TEST_F(BusTest, ErrorRemoteAndLongFramesReachNobody) {
  const auto bus = start(kQuiet);
  int calls = 0;
  const Subscription subscription = bus->subscribe(0x185, [&](const Received&) { ++calls; });
  for (const auto flag : {&Frame::error, &Frame::remote, &Frame::extended}) {
    Frame flagged = frame(0x185);
    flagged.*flag = true;
    EXPECT_EQ(other.link->send(flagged), SendResult::handed_over);
  }
  EXPECT_EQ(other.link->send({.id = 0x10000185, .extended = true}), SendResult::handed_over);
  EXPECT_EQ(other.link->send({.id = 0xFFFFFFFF}), SendResult::handed_over);
  loop.settle();
  EXPECT_EQ(calls, 0);
}

TEST_F(BusTest, HandlersMayComeAndGoWhileOneRuns) {
  const auto bus = start(kQuiet);
  int own = 0;
  int later = 0;
  int removed = 0;
  Subscription self;
  Subscription added;
  Subscription victim;
  self = bus->subscribe(0x185, [&](const Received&) {
    ++own;
    self.reset();
    victim.reset();
    added = bus->subscribe(0x185, [&](const Received&) { ++later; });
  });
  victim = bus->subscribe(0x185, [&](const Received&) { ++removed; });
  EXPECT_EQ(other.link->send(frame(0x185)), SendResult::handed_over);
  loop.settle();
  EXPECT_EQ(own, 1);
  EXPECT_EQ(removed, 0);
  EXPECT_EQ(later, 0) << "called for the event during which it came";
  EXPECT_EQ(other.link->send(frame(0x185)), SendResult::handed_over);
  loop.settle();
  EXPECT_EQ(own, 1);
  EXPECT_EQ(later, 1);
}

TEST_F(BusTest, AnIdentifierBeyond7FFCannotBeSubscribed) {
  const auto bus = start(kQuiet);
  EXPECT_THROW(static_cast<void>(bus->subscribe(0x800, [](const Received&) {})), std::invalid_argument);
}

TEST_F(BusTest, HeartbeatComesAtOnceAndAtItsPeriod) {
  const auto bus = start({.node_id = 127, .heartbeat = 500ms});
  EXPECT_EQ(other.count(0x77F), 1U);
  loop.advance(5s);
  EXPECT_EQ(other.count(0x77F), 11U);
  EXPECT_EQ(other.heard.front().bytes()[0], 5);
}

TEST_F(BusTest, HeartbeatPausesWithTheBusAndReturnsWithIt) {
  const auto bus = start({.node_id = 127, .heartbeat = 500ms});
  wire.set_state({BusCondition::down, 0, 0});
  loop.advance(5s);
  other.heard.clear();
  wire.set_state({BusCondition::error_active, 0, 0});
  loop.settle();
  EXPECT_EQ(other.count(0x77F), 1U);
}

TEST_F(BusTest, NodeZeroAndAZeroPeriodMeanNoHeartbeat) {
  const auto nameless = start({.node_id = 0, .heartbeat = 500ms});
  const auto silent = start({.node_id = 126, .heartbeat = 0ms});
  loop.advance(2s);
  EXPECT_TRUE(other.heard.empty());
}

TEST_F(BusTest, SyncHasNoDataAndDoesNotDrift) {
  const auto bus = start({.node_id = 0, .sync = 10ms});
  loop.advance(10s);
  EXPECT_EQ(other.count(0x080), 1001U);
  EXPECT_EQ(other.heard.front().size, 0);
}

TEST_F(BusTest, MayGoWithoutBeingStopped) {
  auto bus = start({.node_id = 127, .heartbeat = 500ms, .sync = 10ms});
  loop.advance(10ms);
  bus.reset();
  loop.advance(1s);
}

TEST_F(BusTest, LossesAreCountedAndTold) {
  LinkEvents* events = nullptr;
  Bus bus(loop.executor(), std::make_unique<HandLink>(events), kQuiet);
  bus.start();
  std::uint32_t told = 0;
  const Subscription subscription = bus.subscribe_losses([&](std::uint32_t count) { told += count; });
  events->on_frames_lost(3);
  events->on_frames_lost(65534);
  EXPECT_EQ(told, 65537U);
  EXPECT_EQ(bus.statistics().frames_lost, 65537U);
}

// Who wants to know what was on the bus sees it all, and before anybody acted on it.
TEST_F(BusTest, ATapSeesEveryFrameInOrder) {
  struct Tap final : FrameTap {
    void on_frame(const Received& seen, FrameOrigin origin) override {
      frames.emplace_back(seen.frame.id, origin);
      times.push_back(seen.at);
    }
    void on_frames_lost(std::uint32_t count) override { lost += count; }
    std::vector<std::pair<std::uint32_t, FrameOrigin>> frames;
    std::vector<TimePoint> times;
    std::uint32_t lost = 0;
  };
  LinkEvents* events = nullptr;
  Bus bus(loop.executor(), std::make_unique<HandLink>(events), kQuiet);
  bus.start();
  events->on_bus_state({BusCondition::error_active, 0, 0});
  Tap tap;
  std::size_t seen_before = 0;
  const Subscription handler = bus.subscribe(0x705, [&](const Received&) { seen_before = tap.frames.size(); });
  {
    const Subscription tapped = bus.add_tap(tap);
    const Received of_others{frame(0x705, 5), Clock::now(), wall_now()};
    events->on_echo({frame(0x605), Clock::now(), wall_now()});
    events->on_frames({&of_others, 1});
    events->on_error_frame({frame(0x004), Clock::now(), wall_now()}, ErrorSign::other);
    events->on_frames_lost(3);
    EXPECT_EQ(seen_before, 2U);
  }
  events->on_echo({frame(0x606), Clock::now(), wall_now()});
  using enum FrameOrigin;
  EXPECT_EQ(tap.frames,
            (std::vector<std::pair<std::uint32_t, FrameOrigin>>{{0x605, ourselves}, {0x705, others}, {0x004, driver}}));
  EXPECT_EQ(tap.times, std::vector<TimePoint>(3, Clock::now()));
  EXPECT_EQ(tap.lost, 3U);
}

// A socket tells that its interface went down before the frames that waited in it.
TEST_F(BusTest, FramesAndEchoesFromBeforeDownAreIgnored) {
  LinkEvents* events = nullptr;
  Bus bus(loop.executor(), std::make_unique<HandLink>(events), kQuiet);
  bus.start();
  int heard = 0;
  const Subscription subscription = bus.subscribe(0x705, [&](const Received&) { ++heard; });
  const auto receive = [&] {
    const Received received{frame(0x705, 5), Clock::now(), wall_now()};
    events->on_frames({&received, 1});
    events->on_echo({frame(0x605), Clock::now(), {}});
  };
  for (const BusCondition condition : {BusCondition::down, BusCondition::bus_off}) {
    events->on_bus_state({condition, 0, 0});
    receive();
    EXPECT_EQ(heard, 0);
    EXPECT_EQ(bus.statistics().frames_received, 0U);
    EXPECT_EQ(bus.statistics().frames_sent, 0U);
  }
  events->on_bus_state({BusCondition::error_active, 0, 0});
  receive();
  EXPECT_EQ(heard, 1);
  EXPECT_EQ(bus.statistics().frames_sent, 1U);
}

TEST_F(BusTest, LoadIsOfTheLastSecond) {
  const auto bus = start(kQuiet);
  const std::array<std::uint8_t, 8> bytes{};
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(other.link->send(make_frame(0x185, bytes)), SendResult::handed_over);
    loop.advance(10ms);
  }
  // 100 frames of 111 + 9 bits a second at 125 kbit/s.
  EXPECT_NEAR(bus->statistics().load_per_mille, 96, 3);
  loop.advance(2s);
  EXPECT_EQ(bus->statistics().load_per_mille, 0);
  EXPECT_NEAR(bus->statistics().highest_load_per_mille, 96, 3);
}

TEST_F(BusTest, ABusThatIsDownFromTheStartIsNews) {
  wire.set_state({});
  std::vector<BusCondition> told;
  Bus bus(loop.executor(), wire.connect(), kQuiet);
  const Subscription subscription =
      bus.subscribe_state([&](const BusState& state) { told.push_back(state.condition); });
  bus.start();
  loop.settle();
  EXPECT_EQ(told, (std::vector<BusCondition>{BusCondition::down}));
  wire.set_state({});
  loop.settle();
  EXPECT_EQ(told.size(), 1U);
}

}  // namespace
}  // namespace canopen
