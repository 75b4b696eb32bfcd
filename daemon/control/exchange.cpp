#include "daemon/control/exchange.h"

#include "daemon/control/session.h"

namespace gateway::control {

Exchanged exchange(const std::filesystem::path& path, std::string_view request, std::chrono::milliseconds patience) {
  return Session(path).ask(request, patience);
}

}  // namespace gateway::control
