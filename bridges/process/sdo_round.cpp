#include "bridges/process/sdo_round.h"

#include <algorithm>

namespace process {

SdoRound::SdoRound(const SourcePlan& plan) : plan_(&plan), values_(plan.values) {}

void SdoRound::schedule(canopen::TimePoint at) {
  due_ = std::min(due_, at);
}

void SdoRound::schedule_next(canopen::TimePoint now) {
  due_ = std::max(begun_ + plan_->poll, now);
}

void SdoRound::schedule_retry(canopen::TimePoint now, canopen::Duration pause) {
  due_ = now + pause;
}

void SdoRound::cancel() {
  due_ = canopen::TimePoint::max();
  next_ = 0;
  failure_.reset();
  ++id_;
}

void SdoRound::note_begin(canopen::TimePoint now) {
  if (next_ == 0) {
    begun_ = now;
  }
}

SdoRound::Progress SdoRound::store(const canopen::Result<canopen::Raw>& answer) {
  if (answer.has_error()) {
    failure_ = answer.error();
    next_ = 0;
    due_ = canopen::TimePoint::max();
    return Progress::failed;
  }
  values_[object().position] = answer.value();
  if (++next_ < plan_->objects.size()) {
    return Progress::goes_on;
  }
  failure_.reset();
  next_ = 0;
  due_ = canopen::TimePoint::max();
  return Progress::complete;
}

}  // namespace process
