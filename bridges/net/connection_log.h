#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "canopen/clock.h"

namespace net {

/// Where a server tells what a site should know. Empty functions: nowhere.
struct Notices {
  std::function<void(const std::string&)> info{};
  std::function<void(const std::string&)> warning{};
};

/// What connections do, each thing once per address and minute: a client that connects anew for every request, or a
/// scanner, does not fill the log. What was told already costs no memory.
class ConnectionLog {
 public:
  /// `protocol` begins each line: `Modbus`.
  ConnectionLog(std::string protocol, Notices notices) : protocol_(std::move(protocol)), notices_(std::move(notices)) {}
  ConnectionLog(const ConnectionLog&) = delete;
  ConnectionLog& operator=(const ConnectionLog&) = delete;

  /// `what` follows the address in the line.
  void info(std::string_view address, std::string_view what) { tell(address, what, notices_.info); }
  void warn(std::string_view address, std::string_view what) { tell(address, what, notices_.warning); }
  /// Of the server itself: told however much else there is to tell.
  void own_info(std::string_view name, std::string_view what) { tell(name, what, notices_.info, true); }
  void own_warn(std::string_view name, std::string_view what) { tell(name, what, notices_.warning, true); }
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
    bool own;
  };

  [[nodiscard]] std::string line_of(const KeyView& key) const;
  void tell(std::string_view address, std::string_view what, const Sink& sink, bool own = false);

  std::string protocol_;
  Notices notices_;
  std::map<Key, Line, Before> lines_;  ///< Of the last minute.
  std::size_t of_strangers_ = 0;       ///< Lines that are not of the server itself.
};

}  // namespace net
