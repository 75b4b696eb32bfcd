#include "bridges/process/image.h"

#include "bridges/process/source_plan.h"

namespace process {

Image::Image(const config::Drive& model) : values_(model.signals.size()), source_of_(model.signals.size(), kNoSource) {
  for (const SourcePlan& plan : plan_sources(model)) {
    for (const SignalId signal : plan.signals) {
      source_of_[signal] = static_cast<SourceId>(sources_.size());
    }
    sources_.push_back({.source = plan.source});
  }
}

canopen::Raw Image::raw(SignalId signal) const noexcept {
  return values_[signal];
}

bool Image::fresh(SignalId signal, canopen::TimePoint now) const noexcept {
  const SourceState* source = source_of(signal);
  return source != nullptr && source->fresh(now);
}

bool Image::absent(SignalId signal) const noexcept {
  const SourceState* source = source_of(signal);
  return source != nullptr && source->absent;
}

const SourceState* Image::source_of(SignalId signal) const noexcept {
  const SourceId source = source_of_[signal];
  return source == kNoSource ? nullptr : &sources_[source];
}

bool Image::all_fresh(canopen::TimePoint now) const noexcept {
  bool any = sources_.empty();
  for (const SourceState& source : sources_) {
    if (!source.absent && !source.fresh(now)) {
      return false;
    }
    any = any || !source.absent;
  }
  return any;
}

}  // namespace process
