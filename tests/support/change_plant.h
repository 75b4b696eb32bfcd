#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "bridges/process/plant.h"
#include "bridges/process/plant_change.h"
#include "config/difference.h"
#include "config/model.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace support {

/// Another configuration for a plant that runs, as the daemon does it: what goes is stopped, and then all is another at
/// once. Drives that left are gone at the end.
inline void change_plant(HandDrivenLoop& loop, process::Plant& plant, config::Model now,
                         std::vector<process::Plant::BusPort> buses) {
  const config::Difference found = config::difference(plant.model(), now);
  std::vector<std::size_t> left = process::left_behind(found.drives, plant.size());
  const std::shared_ptr<bool> stopped = spawn(loop.executor(), plant.stop(std::move(left)));
  EXPECT_TRUE(loop.advance_until([&stopped] { return *stopped; }, std::chrono::seconds(5)));
  plant.change(std::make_shared<const config::Model>(std::move(now)), std::move(buses),
               {.drives = found.drives, .buses = found.buses});
  plant.forget_left();
}

}  // namespace support
