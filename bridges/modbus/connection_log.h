#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "canopen/clock.h"

namespace modbus {

/// Where a server tells what a site should know. Empty functions: nowhere.
struct Notices {
  std::function<void(const std::string&)> info{};
  std::function<void(const std::string&)> warning{};
};

/// What connections do, each thing once per address and minute: a client that connects anew for every request, or a
/// scanner, does not fill the log.
class ConnectionLog {
 public:
  explicit ConnectionLog(Notices notices) : notices_(std::move(notices)) {}

  /// `what` follows the address in the line.
  void info(const std::string& address, const std::string& what) { tell(address, what, notices_.info); }
  void warn(const std::string& address, const std::string& what) { tell(address, what, notices_.warning); }
  /// Tells how often that happened of which nothing was told for a minute. To be called now and then.
  void sweep();

 private:
  using Sink = std::function<void(const std::string&)>;
  struct Line {
    canopen::TimePoint told;
    std::size_t untold;
    const Sink* sink;
  };

  void tell(const std::string& address, const std::string& what, const Sink& sink);

  Notices notices_;
  std::map<std::pair<std::string, std::string>, Line> lines_;  ///< By address and what; of the last minute.
};

}  // namespace modbus
