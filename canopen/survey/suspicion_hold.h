#pragma once

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
  static constexpr Duration kForget = std::chrono::minutes(1);
  /// One that explains less takes its place when it was not shown for so long.
  static constexpr Duration kGiveWay = std::chrono::seconds(10);

  struct Change {
    std::optional<Suspicion> ended{};
    std::optional<Suspicion> began{};
  };

  /// `judged`: what this look shows.
  [[nodiscard]] Change look(std::optional<Suspicion> judged, TimePoint now, WallTime wall);

  [[nodiscard]] const std::optional<Suspicion>& standing() const noexcept { return standing_; }
  /// When the standing one began.
  [[nodiscard]] WallTime since() const noexcept { return since_; }

 private:
  [[nodiscard]] bool may_begin(const Suspicion& judged, TimePoint now) noexcept;

  std::optional<Suspicion> standing_;
  TimePoint shown_{};  ///< The newest look that showed it.
  WallTime since_{};
  std::optional<SuspicionKind> candidate_;
  unsigned looks_ = 0;  ///< In a row that showed the candidate.
};

}  // namespace canopen
