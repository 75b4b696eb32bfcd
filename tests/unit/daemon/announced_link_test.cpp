#include "daemon/announced_link.h"

#include <gtest/gtest.h>

#include <sstream>

#include "canopen/bus/virtual_link.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"

namespace gateway {
namespace {

using canopen::BusCondition;

TEST(AnnouncedLink, TellsEachStateOnce) {
  support::HandDrivenLoop loop;
  canopen::VirtualBus wire(loop.executor());
  std::ostringstream told;
  simulator::Network network(loop.executor(), make_announced_link(wire.connect(), "vcan0", told));
  network.open();
  loop.settle();
  EXPECT_EQ(told.str(), "vcan0: up (error-active)\n");
  told.str("");
  wire.set_state({BusCondition::error_active, 8, 0});
  loop.settle();
  EXPECT_EQ(told.str(), "") << "only a counter changed";
  wire.set_state({BusCondition::down, 0, 0});
  loop.settle();
  EXPECT_EQ(told.str(), "vcan0: down: the interface is missing or switched off\n");
  network.close();
}

}  // namespace
}  // namespace gateway
