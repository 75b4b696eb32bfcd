#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <string>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/plant.h"
#include "canopen/error.h"

namespace process {

/// A drive that a stop for all did not stop, as far as anybody knows.
struct NotStopped {
  std::size_t drive = 0;  ///< Position in the plant when it answered; the plant may have changed since.
  std::string name;
  canopen::Error error;  ///< `unknown` where no stop value of it is known.
};

/// How many drives in service take commands of this writer: those that a stop for all is for.
[[nodiscard]] std::size_t commanded_by(const Plant& plant, const Writer& writer);

/// One stop for all: the first stop value of its profile to every drive in service that takes commands of this writer,
/// to all of them at once. Where it is for none, each drive notes that it was refused. Returns when each has answered,
/// at the latest after the longest of their deadlines. Tells those that did not confirm; drives that do not name the
/// writer are left alone and not told. `plant` outlives the call.
[[nodiscard]] boost::asio::awaitable<std::vector<NotStopped>> stop_all(Plant& plant, Origin origin);

/// A stop for all that a bridge refuses by itself: each drive notes it, so that it stands in journal and log.
void refuse_stop_all(Plant& plant, const Origin& origin, const canopen::Error& why);

}  // namespace process
