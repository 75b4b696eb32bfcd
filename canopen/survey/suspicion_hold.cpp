#include "canopen/survey/suspicion_hold.h"

#include <utility>

namespace canopen {

SuspicionHold::Change SuspicionHold::look(std::optional<Suspicion> judged, TimePoint now, WallTime wall) {
  Change change;
  if (judged && standing_ && judged->kind == standing_->kind) {
    shown_ = now;
    standing_ = std::move(judged);
    candidate_.reset();
    return change;
  }
  if (judged && may_begin(*judged, now)) {
    change.ended = std::exchange(standing_, std::move(judged));
    change.began = standing_;
    shown_ = now;
    since_ = wall;
    candidate_.reset();
    return change;
  }
  if (!judged) {
    candidate_.reset();
  }
  if (standing_ && now - shown_ >= (standing_->kind == SuspicionKind::wiring ? kForgetWiring : kForget)) {
    change.ended = std::exchange(standing_, std::nullopt);
  }
  return change;
}

bool SuspicionHold::may_begin(const Suspicion& judged, TimePoint now) noexcept {
  looks_ = candidate_ == judged.kind ? looks_ + 1 : 1;
  candidate_ = judged.kind;
  const bool has_place = !standing_ || judged.kind < standing_->kind || now - shown_ >= kGiveWay;
  return has_place && looks_ >= kLooks;
}

}  // namespace canopen
