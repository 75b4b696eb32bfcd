// A node that is left alone while time runs by itself: what only a clock that moves between two looks shows.

#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <memory>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

constexpr int kTurnsOfTheLoop = 5'000;

class LeftAloneTest : public testing::Test {
 protected:
  LeftAloneTest() { bus_.start(); }
  ~LeftAloneTest() override {
    const auto node_stopped = support::spawn(context_.get_executor(), node_.stop());
    turn();
    EXPECT_TRUE(*node_stopped);
    const auto bus_stopped = support::spawn(context_.get_executor(), bus_.stop());
    turn();
    EXPECT_TRUE(*bus_stopped);
  }

  static BusSettings without_heartbeat() {
    BusSettings settings;
    settings.heartbeat = Duration::zero();
    return settings;
  }
  /// Everything that is due, but never for ever.
  void turn() {
    for (int i = 0; i < kTurnsOfTheLoop && context_.poll_one() != 0; ++i) {
    }
  }

  boost::asio::io_context context_{1};
  VirtualBus wire_{context_.get_executor()};
  Bus bus_{context_.get_executor(), wire_.connect(), without_heartbeat()};
  support::ScriptedSlave slave_{context_.get_executor(), wire_, kTestNode};
  RecordedEvents events_;
  RemoteNode node_{context_.get_executor(), bus_, bench_settings(), events_};
};

TEST_F(LeftAloneTest, OperationalWithADifferenceItIsLookedAtOnce) {
  slave_.set(kHeartbeatTime, DataType::u16, 60'000);
  slave_.set_state(5);
  node_.start();
  turn();
  slave_.send(0x705, {5});
  turn();
  ASSERT_EQ(node_.status().boot_result, BootResult::left_alone) << node_.status().boot_text;
  const std::size_t heard = slave_.heard().size();
  for (int i = 0; i < 20; ++i) {
    slave_.send(0x705, {5});
    turn();
  }
  EXPECT_EQ(slave_.heard().size(), heard) << "a drive that waits for a person floods the bus";
}

}  // namespace
}  // namespace canopen
