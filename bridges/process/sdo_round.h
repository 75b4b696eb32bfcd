#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "bridges/process/source_plan.h"
#include "canopen/clock.h"
#include "canopen/error.h"

namespace process {

/// One source read by SDO: object after object into a buffer, so that its values appear together as those of a PDO do.
class SdoRound {
 public:
  explicit SdoRound(const SourcePlan& plan);

  /// Begins a round at `at`, unless one is under way or due earlier.
  void schedule(canopen::TimePoint at);
  /// Begins the next one a poll after the last one began, or now where that has passed already.
  void schedule_next(canopen::TimePoint now);
  void schedule_retry(canopen::TimePoint now, canopen::Duration pause);
  /// No round any more; an answer still under way is forgotten.
  void cancel();

  /// When the next object is to be read; TimePoint::max() where none is.
  [[nodiscard]] canopen::TimePoint due() const noexcept { return due_; }
  [[nodiscard]] const SourcePlan::Object& object() const noexcept { return plan_->objects[next_]; }
  [[nodiscard]] std::uint32_t id() const noexcept { return id_; }

  enum class Progress : std::uint8_t { goes_on, complete, failed };
  /// The answer for object(), which was asked at or after `now`.
  Progress store(const canopen::Result<canopen::Raw>& answer);
  void note_begin(canopen::TimePoint now);
  /// In the positions of the plan; valid after `complete` until the next round begins.
  [[nodiscard]] std::span<const canopen::Raw> values() const noexcept { return values_; }
  /// Why the last round failed; nothing where it did not.
  [[nodiscard]] const std::optional<canopen::Error>& failure() const noexcept { return failure_; }

 private:
  const SourcePlan* plan_;
  canopen::TimePoint due_ = canopen::TimePoint::max();
  canopen::TimePoint begun_{};
  std::size_t next_ = 0;
  std::uint32_t id_ = 0;  ///< Grows when answers of before are not wanted any more.
  std::vector<canopen::Raw> values_;
  std::optional<canopen::Error> failure_;
};

}  // namespace process
