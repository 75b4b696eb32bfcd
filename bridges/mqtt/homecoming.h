#pragma once

#include <chrono>
#include <optional>

namespace mqtt {

/// When the gateway, which is on another broker, goes back to the first: it could be reached each time it was looked
/// for, for long enough. Knows no time but what it is given. Not thread-safe.
class Homecoming {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Milliseconds = std::chrono::milliseconds;

  /// `reachable`: for so long it was; `interval`: so often it is looked for.
  Homecoming(Milliseconds reachable, Milliseconds interval) : reachable_(reachable), interval_(interval) {}

  /// It is to be looked for.
  [[nodiscard]] bool due(TimePoint now) const noexcept { return !looked_ || now - *looked_ >= interval_; }
  /// It was looked for, or tried.
  void looked(bool reached, TimePoint now) noexcept;
  /// It is time to go back.
  [[nodiscard]] bool is_time(TimePoint now) const noexcept { return since_ && now - *since_ >= reachable_; }

 private:
  Milliseconds reachable_;
  Milliseconds interval_;
  std::optional<TimePoint> looked_;
  std::optional<TimePoint> since_;  ///< It could be reached each time.
};

}  // namespace mqtt
