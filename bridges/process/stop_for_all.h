#pragma once

#include <boost/asio/awaitable.hpp>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/plant.h"

namespace process {

/// What became of the stop of one drive.
struct Stopped {
  const Drive* drive = nullptr;
  Outcome outcome;
};

/// One stop for all: every drive that takes commands of this writer gets its stop value, all at the same time. In the
/// order of the configuration; empty where there is no such drive. `plant` outlives it.
[[nodiscard]] boost::asio::awaitable<std::vector<Stopped>> stop_for_all(Plant& plant, Origin origin);

}  // namespace process
