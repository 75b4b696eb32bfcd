#pragma once

#include <boost/asio/basic_waitable_timer.hpp>
#include <chrono>
#include <cstdint>

namespace canopen {

/// Monotonic time for ages, deadlines and timeouts. Never compared with wall time.
/// A test may stop it and move it by hand (see ManualTime).
struct Clock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<Clock>;
  static constexpr bool is_steady = true;

  [[nodiscard]] static time_point now() noexcept;
};

using Duration = Clock::duration;
using TimePoint = Clock::time_point;

/// Time of day, only ever shown to people (`ts`, `since`); never used to decide anything.
using WallTime = std::chrono::sys_time<std::chrono::nanoseconds>;

/// The time of day now; follows ManualTime in tests.
[[nodiscard]] WallTime wall_now() noexcept;

/// No deadline, or nothing due.
inline constexpr TimePoint kNever = TimePoint::max();

/// `at`, or in a millisecond where that has passed: when to look again for what a loop that lags behind has yet to
/// read.
[[nodiscard]] TimePoint or_soon(TimePoint at, TimePoint now = Clock::now()) noexcept;

/// While one lives, both clocks stand still and move only by advance(). A second one begins at the same time again and
/// shares it with the first. Single-threaded tests only.
class ManualTime {
 public:
  /// Wall time starts at 2026-01-02T03:04:05Z, the monotonic clock at one hour.
  ManualTime() noexcept;
  ~ManualTime();
  ManualTime(const ManualTime&) = delete;
  ManualTime& operator=(const ManualTime&) = delete;

  void advance(Duration by) noexcept;
  [[nodiscard]] static bool active() noexcept;
  /// How often the two clocks were read since time was stopped.
  [[nodiscard]] static std::uint64_t readings() noexcept;
};

/// Tells Asio how long to sleep: not at all while time is moved by hand, so that poll() finds every due timer.
struct WaitTraits {
  [[nodiscard]] static Duration to_wait_duration(const Duration& duration) noexcept;
  [[nodiscard]] static Duration to_wait_duration(const TimePoint& expiry) noexcept;
};

using Timer = boost::asio::basic_waitable_timer<Clock, WaitTraits>;

}  // namespace canopen
