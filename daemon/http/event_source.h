#pragma once

#include <string>

#include "canopen/clock.h"

namespace gateway::http {

/// The events of one reader's stream of his own.
class EventSource {
 public:
  EventSource() = default;
  virtual ~EventSource() = default;
  EventSource(const EventSource&) = delete;
  EventSource& operator=(const EventSource&) = delete;

  /// Appends the events that are due: half a millisecond's work at most. True: there are more at once.
  [[nodiscard]] virtual bool take(std::string& events) = 0;
  /// When to ask again, where there are none.
  [[nodiscard]] virtual canopen::Duration pace() const = 0;
};

}  // namespace gateway::http
