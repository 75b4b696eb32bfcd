#include "daemon/supervision.h"

#include <gtest/gtest.h>

#include "canopen/bus.h"
#include "canopen/virtual_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/unit/daemon/demo_model.h"

namespace gateway {
namespace {

TEST(StatusLine, CountsDrivesOnlineAndAlarmsWhereThereAreSome) {
  support::HandDrivenLoop loop;
  canopen::VirtualBus wire(loop.executor());
  canopen::Bus bus(loop.executor(), wire.connect(), {});
  const config::Model model = test::demo_model();
  const process::Plant plant(loop.executor(), model, {{&bus, [&bus] { return bus.statistics(); }}});
  EXPECT_EQ(status_line(plant), "0 of 4 drives online");
}

}  // namespace
}  // namespace gateway
