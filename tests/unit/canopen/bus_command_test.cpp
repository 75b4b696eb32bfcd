#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "canopen/bus/bus.h"
#include "tests/support/bus_fixture.h"
#include "tests/support/spawn.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;
using support::HandLink;
using support::kQuiet;

class BusCommandTest : public support::BusFixture {};

TEST_F(BusCommandTest, ACommandIsConfirmedByItsEcho) {
  const auto bus = start({.node_id = 127, .heartbeat = 500ms});
  loop.advance(10ms);
  const auto result =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  loop.settle();
  ASSERT_TRUE(result.done());
  EXPECT_TRUE(result.get().has_value());
  EXPECT_EQ(other.count(0x205), 1U);
}

TEST_F(BusCommandTest, OnASilentBusOurHeartbeatGoesBeforeTheCommand) {
  const auto bus = start({.node_id = 127, .heartbeat = 60s});
  loop.advance(30s);
  other.heard.clear();
  const auto result =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x000, 1), Clock::now() + 800ms));
  loop.settle();
  ASSERT_TRUE(result.done());
  EXPECT_TRUE(result.get().has_value());
  ASSERT_EQ(other.heard.size(), 2U);
  EXPECT_EQ(other.heard[0].id, 0x77FU);
  EXPECT_EQ(other.heard[1].id, 0x000U);
}

TEST_F(BusCommandTest, WithoutHeartbeatACommandOnASilentBusIsWithdrawn) {
  const auto bus = start(kQuiet);
  const auto result =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  loop.advance(2s);
  ASSERT_TRUE(result.done());
  EXPECT_EQ(result.get().error().kind, ErrorKind::timeout);
  EXPECT_FALSE(result.get().error().outcome_unknown);
  EXPECT_EQ(other.link->send(frame(0x705)), SendResult::handed_over);
  loop.advance(1s);
  EXPECT_EQ(other.count(0x205), 0U);
}

TEST_F(BusCommandTest, AReceivedFrameIsASignOfLife) {
  const auto bus = start(kQuiet);
  const auto result =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  loop.advance(100ms);
  EXPECT_FALSE(result.done());
  EXPECT_EQ(other.link->send(frame(0x705)), SendResult::handed_over);
  loop.settle();
  ASSERT_TRUE(result.done());
  EXPECT_TRUE(result.get().has_value());
}

TEST_F(BusCommandTest, WithoutEchoTheOutcomeIsUnknown) {
  const auto bus = start({.node_id = 127, .heartbeat = 500ms});
  loop.advance(10ms);
  wire.withhold_echoes(true);
  const auto result =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  loop.advance(100ms);
  ASSERT_TRUE(result.done());
  EXPECT_EQ(result.get().error().kind, ErrorKind::timeout);
  EXPECT_TRUE(result.get().error().outcome_unknown);

  const auto refused =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  loop.settle();
  ASSERT_TRUE(refused.done());
  EXPECT_EQ(refused.get().error().kind, ErrorKind::offline);

  wire.withhold_echoes(false);
  loop.advance(1s);  // Our heartbeat comes back.
  const auto next = support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  loop.settle();
  ASSERT_TRUE(next.done());
  EXPECT_TRUE(next.get().has_value());
}

TEST_F(BusCommandTest, ABusThatGoesOffAnswersAtOnce) {
  const auto bus = start(kQuiet);
  std::vector<BusCondition> told;
  const Subscription subscription =
      bus->subscribe_state([&](const BusState& state) { told.push_back(state.condition); });
  const auto result =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  wire.set_state({BusCondition::bus_off, 255, 0});
  loop.settle();
  ASSERT_TRUE(result.done());
  EXPECT_EQ(result.get().error().kind, ErrorKind::offline);
  EXPECT_FALSE(bus->send(TransmitClass::sdo, frame(0x605), Clock::now() + 1s));
  EXPECT_FALSE(bus->send(TransmitClass::repetition, frame(0x205), Clock::now() + 1s));

  wire.set_state({BusCondition::bus_off, 0, 0});  // The same bus-off, other counters.
  wire.set_state({BusCondition::error_active, 0, 0});
  wire.set_state({BusCondition::error_active, 0, 0});
  loop.settle();
  EXPECT_TRUE(bus->send(TransmitClass::sdo, frame(0x605), Clock::now() + 1s));
  EXPECT_EQ(bus->statistics().bus_offs, 1U);
  EXPECT_EQ(told.front(), BusCondition::bus_off);
  EXPECT_EQ(told.back(), BusCondition::error_active);
}

TEST_F(BusCommandTest, StoppingAnswersWhatWaitsAndSendsNothingMore) {
  const auto bus = start({.node_id = 127, .heartbeat = 500ms, .sync = 10ms});
  loop.advance(10ms);
  wire.withhold_echoes(true);
  const auto in_kernel =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  const auto waiting =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x206, 1), Clock::now() + 800ms));
  loop.settle();
  const auto stopped = support::spawn(loop.executor(), bus->stop());
  loop.settle();
  ASSERT_TRUE(*stopped);
  ASSERT_TRUE(in_kernel.done());
  EXPECT_TRUE(in_kernel.get().error().outcome_unknown);
  ASSERT_TRUE(waiting.done());
  EXPECT_EQ(waiting.get().error().kind, ErrorKind::offline);
  other.heard.clear();
  loop.advance(5s);
  EXPECT_TRUE(other.heard.empty());
  EXPECT_FALSE(bus->send(TransmitClass::sdo, frame(0x605), Clock::now() + 1s));
  const auto after =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  loop.settle();
  ASSERT_TRUE(after.done());
  EXPECT_EQ(after.get().error().kind, ErrorKind::offline);
}

TEST_F(BusCommandTest, BehindAHeartbeatThatIsStuckACommandIsWithdrawn) {
  const auto bus = start({.node_id = 127, .heartbeat = 500ms});
  loop.advance(10ms);
  wire.withhold_echoes(true);
  loop.advance(520ms);  // It is stuck.
  other.heard.clear();
  EXPECT_EQ(other.link->send(frame(0x705)), SendResult::handed_over);
  const auto result =
      support::spawn(loop.executor(), support::send_command(*bus, frame(0x205, 1), Clock::now() + 800ms));
  for (int i = 0; i < 8; ++i) {
    loop.advance(100ms);
    EXPECT_EQ(other.link->send(frame(0x705)), SendResult::handed_over);
  }
  ASSERT_TRUE(result.done());
  EXPECT_EQ(result.get().error().kind, ErrorKind::timeout);
  EXPECT_EQ(other.count(0x205), 0U);
  EXPECT_LE(other.count(0x77F), 9U) << "once in a tenth of a second, as long as it may tell";
  EXPECT_GE(other.count(0x77F), 2U);
}

TEST_F(BusCommandTest, ALinkThatStaysBusyIsNotAskedForEver) {
  // The heartbeat that a command asks for must not ask for another one.
  LinkEvents* events = nullptr;
  Bus bus(loop.executor(), std::make_unique<HandLink>(events), {.node_id = 127, .heartbeat = 500ms});
  bus.start();
  events->on_bus_state({BusCondition::error_active, 0, 0});
  const auto result =
      support::spawn(loop.executor(), support::send_command(bus, frame(0x205, 1), Clock::now() + 800ms));
  loop.advance(800ms);
  ASSERT_TRUE(result.done());
  EXPECT_EQ(result.get().error().kind, ErrorKind::timeout);
  EXPECT_FALSE(result.get().error().outcome_unknown);
}

}  // namespace
}  // namespace canopen
