#include "canopen/survey/suspicion_hold.h"

#include <utility>

namespace canopen {
namespace {

bool is_lately(const std::optional<TimePoint>& at, TimePoint now) noexcept {
  return at && now - *at < SuspicionHold::kForget;
}

}  // namespace

SuspicionHold::Change SuspicionHold::look(std::optional<Suspicion> judged, TimePoint now, WallTime wall) {
  Change change;
  if (judged && standing_ && judged->kind == standing_->kind) {
    shown_ = now;
    standing_ = std::move(judged);
    candidate_.reset();
    return change;
  }
  if (judged && may_begin(*judged, now)) {
    return begin(std::move(*judged), now, wall);
  }
  if (!judged) {
    candidate_.reset();
  }
  if (standing_ && now - shown_ >= (standing_->kind == SuspicionKind::wiring ? kForgetWiring : kForget)) {
    change.ended = drop();
  }
  return change;
}

std::optional<Suspicion> SuspicionHold::drop() noexcept {
  candidate_.reset();
  before_ = {};
  return std::exchange(standing_, std::nullopt);
}

SuspicionHold::Change SuspicionHold::begin(Suspicion judged, TimePoint now, WallTime wall) {
  if (standing_) {
    before(standing_->kind).shown = shown_;
    before(standing_->kind).since = since_;
  }
  Before& same = before(judged.kind);
  since_ = is_lately(same.shown, now) ? same.since : wall;
  shown_ = now;
  candidate_.reset();
  Change change{.displaced = std::exchange(standing_, std::move(judged))};
  if (is_lately(same.told, now)) {
    return {};
  }
  same.told = now;
  change.began = standing_;
  return change;
}

bool SuspicionHold::may_begin(const Suspicion& judged, TimePoint now) noexcept {
  looks_ = candidate_ == judged.kind ? looks_ + 1 : 1;
  candidate_ = judged.kind;
  const bool has_place = !standing_ || judged.kind < standing_->kind || now - shown_ >= kGiveWay;
  return has_place && looks_ >= kLooks;
}

}  // namespace canopen
