#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "bridges/alarms/data_problem.h"
#include "bridges/process/source_plan.h"
#include "canopen/clock.h"
#include "canopen/error.h"

namespace process {

/// Values are fresh for so many periods, and polls.
inline constexpr int kFreshPeriods = 3;

/// Whether one TPDO comes as it should while its drive is operational, and whether SDO reads stand in for it.
class TpdoWatch {
 public:
  explicit TpdoWatch(const SourcePlan& plan);

  /// It comes with a period; one that comes on change is never late.
  [[nodiscard]] bool cyclic() const noexcept { return period_ > canopen::Duration::zero(); }

  void begin(canopen::TimePoint now);
  void end();

  void on_frame(canopen::TimePoint at);
  /// Of one on change nobody knows what it told: SDO reads stand in for it from then on.
  void on_too_short(std::size_t expected, std::size_t received);

  /// When expire() has to look; TimePoint::max() for never.
  [[nodiscard]] canopen::TimePoint due() const noexcept { return overdue_ ? canopen::TimePoint::max() : due_; }
  /// Overdue where due() has passed. One whose transmission type is not `verified` may well come on change only, so
  /// that SDO reads stand in for it from then on.
  void expire(canopen::TimePoint now, bool verified);
  /// Until the TPDO comes in time again.
  [[nodiscard]] bool substituted() const noexcept { return substituted_; }

  /// Nothing where nothing is wrong. `read_failure` is why its objects could not be read, which are not fresh.
  [[nodiscard]] std::optional<alarms::DataProblem> problem(const std::optional<canopen::Error>& read_failure) const;

 private:
  struct Lengths {
    std::size_t expected;
    std::size_t received;
  };

  std::uint16_t number_;
  canopen::Duration period_;
  bool active_ = false;
  bool overdue_ = false;
  bool substituted_ = false;
  std::uint8_t in_time_ = 0;  ///< TPDOs in time, one after the other.
  canopen::TimePoint due_ = canopen::TimePoint::max();
  canopen::TimePoint last_frame_{};
  std::optional<Lengths> too_short_;
};

}  // namespace process
