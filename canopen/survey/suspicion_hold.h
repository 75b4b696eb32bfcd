#pragma once

#include <array>
#include <optional>

#include "canopen/clock.h"
#include "canopen/survey/suspicion.h"

namespace canopen {

/// Keeps one suspicion from coming and going: it begins with the third look in a row that shows it, and ends when none
/// showed it for a time. A plain value.
class SuspicionHold {
 public:
  static constexpr unsigned kLooks = 3;
  /// Of wiring, which comes and goes with vibration, motors and weather.
  static constexpr Duration kForgetWiring = std::chrono::minutes(10);
  /// Of the others. One that was displaced and is back within that time is told once, and is as old as it was.
  static constexpr Duration kForget = std::chrono::minutes(1);
  /// One that explains less takes its place when it was not shown for so long.
  static constexpr Duration kGiveWay = std::chrono::seconds(10);

  struct Change {
    std::optional<Suspicion> ended{};
    std::optional<Suspicion> began{};
    /// Whose place `began` took: nothing is known of whether its reason is gone.
    std::optional<Suspicion> displaced{};
  };

  /// `judged`: what this look shows.
  [[nodiscard]] Change look(std::optional<Suspicion> judged, TimePoint now, WallTime wall);
  /// There is nothing to look at any more. What stood.
  std::optional<Suspicion> drop() noexcept;

  [[nodiscard]] const std::optional<Suspicion>& standing() const noexcept { return standing_; }
  /// When the standing one began.
  [[nodiscard]] WallTime since() const noexcept { return since_; }
  /// The newest look that showed the standing one; its words are of then.
  [[nodiscard]] TimePoint shown() const noexcept { return shown_; }

 private:
  /// Of a kind that stood.
  struct Before {
    WallTime since{};
    std::optional<TimePoint> shown{};
    std::optional<TimePoint> told{};
  };
  [[nodiscard]] Before& before(SuspicionKind kind) noexcept { return before_[static_cast<std::size_t>(kind)]; }
  [[nodiscard]] bool may_begin(const Suspicion& judged, TimePoint now) noexcept;
  [[nodiscard]] Change begin(Suspicion judged, TimePoint now, WallTime wall);

  std::optional<Suspicion> standing_;
  TimePoint shown_{};
  WallTime since_{};
  std::array<Before, kSuspicionKinds.size()> before_{};
  std::optional<SuspicionKind> candidate_;
  unsigned looks_ = 0;  ///< In a row that showed the candidate.
};

}  // namespace canopen
