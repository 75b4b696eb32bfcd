#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "canopen/bus/virtual_link.h"
#include "daemon/gateway.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace gateway::test {

/// The gateway of `model` and the simulated drives that it names, on an in-process bus and the hand-driven clock.
class DemoPlant : public testing::Test {
 protected:
  explicit DemoPlant(config::Model model) : model_(std::move(model)) {
    for (const config::Drive& drive : model_.drives) {
      drives_.push_back(simulator::make_drive(drive.profile, drive.node.node, network_, {}));
    }
  }
  /// All drives are online, and show values, when it returns.
  void begin_plant() {
    gateway_.start();
    network_.open();
    for (const auto& drive : drives_) {
      drive->power_on();
    }
    EXPECT_TRUE(
        loop_.advance_until([this] { return gateway_.plant().online() == drives_.size(); }, std::chrono::seconds(10)));
    loop_.advance(std::chrono::seconds(2));
  }
  /// For the destructor of whoever added observers to the plant: they hear its end.
  void end_plant() {
    const auto stopped = support::spawn(loop_.executor(), gateway_.stop());
    EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, std::chrono::seconds(5)));
  }

  support::HandDrivenLoop loop_;
  config::Model model_;
  canopen::VirtualBus wire_{loop_.executor()};
  simulator::Network network_{loop_.executor(), wire_.connect()};
  std::vector<std::unique_ptr<simulator::Drive>> drives_;
  Gateway gateway_{loop_.executor(), model_, [this](const config::Bus&) { return wire_.connect(); }};
};

}  // namespace gateway::test
