#pragma once

#include <cstdint>
#include <string>

#include "daemon/http/target.h"

namespace gateway::http {

enum class Method : std::uint8_t { get, head };

/// A request that may be answered.
struct Request {
  Method method = Method::get;
  Target target;
  std::string host;        ///< As the client wrote it, with its port.
  bool keep_alive = true;  ///< The connection goes on behind it.
};

}  // namespace gateway::http
