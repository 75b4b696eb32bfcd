#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/unit/daemon/descriptor.h"

namespace gateway::test {

/// A service manager's ear (sd_notify(3)): a datagram socket with a name in no directory.
class NotifySocket {
 public:
  NotifySocket();

  /// What NOTIFY_SOCKET is to be.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// What was said since the last call, in its order.
  [[nodiscard]] std::vector<std::string> heard();
  /// Waits for the next message; nothing where none comes for ten seconds.
  [[nodiscard]] std::optional<std::string> next();

 private:
  Descriptor socket_;
  std::string name_;
};

}  // namespace gateway::test
