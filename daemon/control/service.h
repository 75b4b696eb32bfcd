#pragma once

#include <boost/asio/awaitable.hpp>
#include <functional>
#include <memory>
#include <string>

#include "canopen/clock.h"
#include "daemon/control/request.h"
#include "daemon/control/stream.h"

namespace gateway::control {

/// A request, and who sent it when.
struct Asked {
  Request request;
  std::string id = "null";  ///< To echo, as JSON text.
  std::string user;         ///< The name of the client's user, or its number where it has none.
  canopen::TimePoint received{};
};

/// Begins what is_stream() says of a request; `id`: JSON text.
using OpenStream =
    std::function<canopen::Result<std::unique_ptr<Stream>>(const Request& request, const std::string& id)>;

/// Who carries out what clients ask for.
struct Service {
  /// No limit delays or refuses these.
  std::function<bool(const Request&)> is_stop;
  /// The answer: one JSON object without a line break. Begun in the order in which requests came.
  std::function<boost::asio::awaitable<std::string>(Asked)> answer;
  OpenStream open_stream{};
};

}  // namespace gateway::control
