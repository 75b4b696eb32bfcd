#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace mqtt {

/// When the gateway, which is on another broker, goes back to the first: it could be reached each time it was looked
/// for, for long enough, and then took a connection on trial. Each trial or return that fails doubles that time, until
/// the first broker was in use for as long as it takes at the beginning: a broker that answers and cannot be used costs
/// those at the other one nothing, or hardly anything. Knows no time but what it is given. Not thread-safe.
class Homecoming {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  using Milliseconds = std::chrono::milliseconds;
  enum class Step : std::uint8_t { none, look, try_it };

  /// Longest time in which it must have been reached, where that is not the shortest.
  static constexpr std::chrono::hours kLongest{4};
  /// Longest time between two looks, likewise: each is a line in that broker's log.
  static constexpr std::chrono::minutes kRarest{5};

  /// `reachable`: for so long it was, at the beginning; `interval`: so often it is looked for then.
  Homecoming(Milliseconds reachable, Milliseconds interval)
      : shortest_(reachable), reachable_(reachable), interval_(interval) {}

  /// What is to be done now; looked() or tried() tells what came of it.
  [[nodiscard]] Step due(TimePoint now) const noexcept;
  /// Whether it could be reached.
  void looked(bool reached, TimePoint now) noexcept;
  /// Whether it took a connection.
  void tried(bool taken, TimePoint now) noexcept;
  /// It may be gone back to: the last trial succeeded, and each look since.
  [[nodiscard]] bool may_go() const noexcept { return taken_.has_value(); }

  /// The other broker was left for it.
  void went() noexcept { returning_ = arriving_ = true; }
  /// Its turn is the first since then.
  [[nodiscard]] bool is_arriving() const noexcept { return arriving_; }
  /// Its turn ended, after a connection of so long; 0: there was none. `stays`: it is the first one's turn again.
  void ended(Milliseconds stood, bool stays, TimePoint now) noexcept;

 private:
  void fail(TimePoint now) noexcept;
  /// So often it is looked for: the more rarely, the longer it must have been reached.
  [[nodiscard]] Milliseconds interval() const noexcept;

  Milliseconds shortest_;
  Milliseconds reachable_;
  Milliseconds interval_;
  bool returning_ = false;  ///< It was not in use for long since.
  bool arriving_ = false;
  std::optional<TimePoint> looked_;
  std::optional<TimePoint> since_;  ///< It could be reached each time.
  std::optional<TimePoint> taken_;  ///< When the last trial succeeded.
};

}  // namespace mqtt
