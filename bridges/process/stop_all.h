#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/plant.h"
#include "canopen/error.h"

namespace process {

/// What became of one stop for all drives.
struct StoppedAll {
  struct Missed {
    std::string drive;
    canopen::Error error;
  };

  std::size_t asked = 0;         ///< Drives in service that take commands of this writer.
  std::vector<Missed> missed{};  ///< Those that did not confirm, or have no stop value; in the order of the plant.

  /// One outcome for all: confirmed where each drive confirmed it, and at least one was asked; else the kind of the
  /// first that did not, with all of them named.
  [[nodiscard]] Outcome outcome() const;
};

/// Stops every drive that takes commands of this writer by the first stop value of its profile, all at once. Returns
/// when the last one is answered. `plant` outlives it.
boost::asio::awaitable<StoppedAll> stop_all(Plant& plant, Origin origin);

}  // namespace process
