#pragma once

#include <string>

#include "canopen/clock.h"

namespace gateway::control {

/// What a client is told on and on, a JSON object a line.
class Stream {
 public:
  Stream() = default;
  virtual ~Stream() = default;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// Appends the lines that are due, each with its end: half a millisecond's work at most. True: there are more at
  /// once.
  [[nodiscard]] virtual bool take(std::string& lines) = 0;
  /// When to ask again, where there are none.
  [[nodiscard]] virtual canopen::Duration pace() const = 0;
};

}  // namespace gateway::control
