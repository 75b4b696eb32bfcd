#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "canopen/clock.h"

namespace modbus {

/// Where a server tells what a site should know. Empty functions: nowhere.
struct Notices {
  std::function<void(const std::string&)> info{};
  std::function<void(const std::string&)> warning{};
};

/// What connections do, each thing once per address and minute: a client that connects anew for every request, or a
/// scanner, does not fill the log. What was told already costs no memory.
class ConnectionLog {
 public:
  explicit ConnectionLog(Notices notices) : notices_(std::move(notices)) {}
  ConnectionLog(const ConnectionLog&) = delete;
  ConnectionLog& operator=(const ConnectionLog&) = delete;

  /// `what` follows the address in the line.
  void info(std::string_view address, std::string_view what) { tell(address, what, notices_.info); }
  void warn(std::string_view address, std::string_view what) { tell(address, what, notices_.warning); }
  /// Tells how often that happened of which nothing was told for a minute. To be called each second.
  void sweep();

 private:
  using Sink = std::function<void(const std::string&)>;
  using Key = std::pair<std::string, std::string>;  ///< Address and what.
  using KeyView = std::pair<std::string_view, std::string_view>;
  struct Before {
    using is_transparent = void;
    bool operator()(const KeyView& one, const KeyView& other) const noexcept { return one < other; }
  };
  struct Line {
    canopen::TimePoint told;
    std::size_t untold;
    const Sink* sink;
  };

  void tell(std::string_view address, std::string_view what, const Sink& sink);

  Notices notices_;
  std::map<Key, Line, Before> lines_;  ///< Of the last minute.
};

}  // namespace modbus
