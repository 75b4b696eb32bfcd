#include "bridges/process/tpdo_watch.h"

#include <algorithm>
#include <utility>

namespace process {
namespace {

/// Drives send their first TPDO when they find the time after the start; silence means something only after that.
constexpr canopen::Duration kFirstFrame = std::chrono::milliseconds(500);
/// So many TPDOs in time end the reading in their place.
constexpr std::uint8_t kRegular = 3;

}  // namespace

TpdoWatch::TpdoWatch(const SourcePlan& plan) : number_(plan.source.number), period_(plan.period) {}

void TpdoWatch::begin(canopen::TimePoint now) {
  end();
  active_ = true;
  if (cyclic()) {
    due_ = now + std::max(kFreshPeriods * period_, kFirstFrame);
  }
}

void TpdoWatch::end() {
  active_ = false;
  overdue_ = false;
  substituted_ = false;
  in_time_ = 0;
  due_ = canopen::TimePoint::max();
  too_short_.reset();
}

void TpdoWatch::on_frame(canopen::TimePoint at) {
  if (!active_) {
    return;
  }
  const bool in_time = at - last_frame_ <= kFreshPeriods * period_;
  last_frame_ = at;
  overdue_ = false;
  too_short_.reset();
  if (cyclic()) {
    due_ = at + kFreshPeriods * period_;
    in_time_ = in_time ? static_cast<std::uint8_t>(std::min<int>(in_time_ + 1, kRegular)) : std::uint8_t{0};
    substituted_ = substituted_ && in_time_ < kRegular;
  } else {
    substituted_ = false;
  }
}

void TpdoWatch::on_too_short(std::size_t expected, std::size_t received) {
  if (active_) {
    too_short_ = Lengths{expected, received};
    substituted_ = substituted_ || !cyclic();
  }
}

void TpdoWatch::expire(canopen::TimePoint now, bool verified) {
  if (now <= due()) {
    return;
  }
  overdue_ = true;
  in_time_ = 0;
  substituted_ = substituted_ || !verified;
}

std::optional<alarms::DataProblem> TpdoWatch::problem(const std::optional<canopen::Error>& read_failure) const {
  using alarms::DataProblem;
  using alarms::DataReason;
  if (!active_) {
    return std::nullopt;
  }
  const std::string name = "TPDO" + std::to_string(number_);
  if (too_short_) {
    std::string text = name + " has " + std::to_string(too_short_->received) + " bytes, expected " +
                       std::to_string(too_short_->expected) + ", and is not decoded";
    return DataProblem{DataReason::too_short, std::move(text)};
  }
  if (overdue_ && !substituted_) {
    return DataProblem{DataReason::overdue, name + " is overdue"};
  }
  if (read_failure && (overdue_ || !cyclic())) {
    std::string text = name + (overdue_ ? " is overdue" : " has not come") +
                       " and reading its objects failed: " + canopen::to_string(*read_failure);
    return DataProblem{DataReason::unreadable, std::move(text)};
  }
  return std::nullopt;
}

}  // namespace process
