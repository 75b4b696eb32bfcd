#include "daemon/supervision.h"

#include <gmock/gmock.h>

#include <memory>
#include <vector>

#include "canopen/bus/virtual_link.h"
#include "daemon/gateway.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/demo_model.h"
#include "tests/unit/daemon/environment.h"
#include "tests/unit/daemon/notify_socket.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;
using test::Environment;
using test::NotifySocket;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

/// The demo's gateway without its bridges, and its drives, not yet switched on.
class SupervisedGateway : public testing::Test {
 protected:
  SupervisedGateway() {
    model_.modbus.reset();
    model_.mqtt.reset();
    network_.open();
    for (const config::Drive& drive : model_.drives) {
      drives_.push_back(simulator::make_drive(drive.profile, drive.node.node, network_));
    }
    gateway_ = std::make_unique<Gateway>(loop_.executor(), model_,
                                         [this](const config::Bus& /*bus*/) { return wire_.connect(); });
    gateway_->start();
  }
  ~SupervisedGateway() override {
    const auto stopped = support::spawn(loop_.executor(), gateway_->stop());
    EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, 5s));
    drives_.clear();
    network_.close();
    loop_.settle();
  }

  /// False when they are not all online soon.
  [[nodiscard]] bool switch_drives_on() {
    for (const auto& drive : drives_) {
      drive->power_on();
    }
    return loop_.advance_until([this] { return gateway_->plant().online() == drives_.size(); }, 10s);
  }
  [[nodiscard]] std::string line() { return status_line(gateway_->plant()); }

  NotifySocket manager_;
  Environment notify_socket_{"NOTIFY_SOCKET", manager_.name()};
  Environment no_watchdog_{"WATCHDOG_USEC", std::nullopt};
  Environment any_process_{"WATCHDOG_PID", std::nullopt};
  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  config::Model model_ = test::demo_model();
  simulator::Network network_{loop_.executor(), wire_.connect()};
  std::vector<std::unique_ptr<simulator::Drive>> drives_;
  std::unique_ptr<Gateway> gateway_;
};

TEST_F(SupervisedGateway, StatusLineCountsDrivesOnlineAndAlarmsWhereThereAreSome) {
  EXPECT_EQ(line(), "0 of 4 drives online");
  ASSERT_TRUE(switch_drives_on());
  EXPECT_EQ(line(), "4 of 4 drives online");
  drives_[0]->fault(4);
  loop_.advance(100ms);
  EXPECT_EQ(line(), "4 of 4 drives online, 1 with an alarm");
  drives_[1]->fault(5);
  drives_[1]->power_off();
  loop_.advance(3s);
  EXPECT_EQ(line(), "3 of 4 drives online, 2 with an alarm");
}

TEST_F(SupervisedGateway, TellsThatItIsReadyAndEachChangeOfItsStatusOnce) {
  ASSERT_TRUE(switch_drives_on());
  Supervision supervision(loop_.executor(), gateway_->plant(), [] { return true; });
  EXPECT_THAT(manager_.heard(), IsEmpty());
  supervision.ready();
  EXPECT_THAT(manager_.heard(), ElementsAre("READY=1", "STATUS=4 of 4 drives online"));
  loop_.advance(5s);
  EXPECT_THAT(manager_.heard(), IsEmpty()) << "nothing changed";
  drives_[2]->power_off();
  loop_.advance(10s);
  EXPECT_THAT(manager_.heard(), ElementsAre("STATUS=4 of 4 drives online, 1 with an alarm",  // its values are overdue
                                            "STATUS=3 of 4 drives online, 1 with an alarm"));
  supervision.stopping();
  loop_.advance(5s);
  EXPECT_THAT(manager_.heard(), ElementsAre("STOPPING=1"));
}

TEST_F(SupervisedGateway, GivesThreeSignsOfLifePerWatchdogTimeUntilItStops) {
  const Environment watchdog("WATCHDOG_USEC", "1500000");
  Supervision supervision(loop_.executor(), gateway_->plant(), [] { return true; });
  supervision.ready();
  EXPECT_THAT(manager_.heard(), ElementsAre("READY=1", "WATCHDOG=1", "STATUS=0 of 4 drives online"));
  loop_.advance(499ms);
  EXPECT_THAT(manager_.heard(), IsEmpty());
  loop_.advance(1ms);
  EXPECT_THAT(manager_.heard(), ElementsAre("WATCHDOG=1"));
  loop_.advance(500ms);
  EXPECT_THAT(manager_.heard(), ElementsAre("WATCHDOG=1"));
  supervision.stopping();
  loop_.advance(5s);
  EXPECT_THAT(manager_.heard(), ElementsAre("STOPPING=1")) << "a dying gateway that hangs is to be ended";
}

TEST_F(SupervisedGateway, GivesASignOfLifeEachSecondUnderALongWatchdogTime) {
  const Environment watchdog("WATCHDOG_USEC", "60000000");
  Supervision supervision(loop_.executor(), gateway_->plant(), [] { return true; });
  supervision.ready();
  (void)manager_.heard();
  loop_.advance(1s);
  EXPECT_THAT(manager_.heard(), ElementsAre("WATCHDOG=1"));
  supervision.stopping();
}

TEST_F(SupervisedGateway, GivesNoSignOfLifeForAThreadThatStandsStill) {
  const Environment watchdog("WATCHDOG_USEC", "1500000");
  bool alive = true;
  Supervision supervision(loop_.executor(), gateway_->plant(), [&alive] { return alive; });
  supervision.ready();
  (void)manager_.heard();
  alive = false;
  loop_.advance(5s);
  EXPECT_THAT(manager_.heard(), Not(Contains("WATCHDOG=1")));
  alive = true;
  loop_.advance(500ms);
  EXPECT_THAT(manager_.heard(), ElementsAre("WATCHDOG=1"));
  supervision.stopping();
}

TEST_F(SupervisedGateway, TheWatchdogOfAnotherProcessIsNotOurs) {
  const Environment watchdog("WATCHDOG_USEC", "1500000");
  const Environment another("WATCHDOG_PID", "1");
  Supervision supervision(loop_.executor(), gateway_->plant(), [] { return true; });
  supervision.ready();
  EXPECT_THAT(manager_.heard(), ElementsAre("READY=1", "STATUS=0 of 4 drives online"));
  supervision.stopping();
}

}  // namespace
}  // namespace gateway
