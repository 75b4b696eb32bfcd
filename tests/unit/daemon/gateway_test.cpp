#include "daemon/gateway.h"

#include <gtest/gtest.h>

#include "canopen/bus/virtual_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/demo_model.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;

class GatewayTest : public testing::Test {
 protected:
  GatewayTest() {
    model_.modbus.reset();
    model_.mqtt.reset();
  }

  /// Whether there is an alarm of the bus soon after a start.
  bool alarm_after_start() {
    Gateway gateway(loop_.executor(), model_, [this](const config::Bus&) { return wire_.connect(); });
    gateway.start();
    loop_.advance(100ms);
    const bool active = gateway.plant().bus_alarm(0).active;
    const auto stopped = support::spawn(loop_.executor(), gateway.stop());
    EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, 5s));
    return active;
  }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  config::Model model_ = test::demo_model();
};

TEST_F(GatewayTest, TellsABusThatIsDownFromTheStart) {
  wire_.set_state({canopen::BusCondition::down, 0, 0});
  EXPECT_TRUE(alarm_after_start());
}

TEST_F(GatewayTest, TellsNothingOfABusThatWorks) {
  EXPECT_FALSE(alarm_after_start());
}

}  // namespace
}  // namespace gateway
