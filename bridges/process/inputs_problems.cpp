// What is wrong with the sources of Inputs, for the alarm `data`.

#include <utility>

#include "bridges/process/inputs.h"

namespace process {

void Inputs::set_absent(SourceId source, bool absent) {
  SourceState& state = image_.sources_[source];
  if (std::exchange(state.absent, absent) == absent) {
    return;
  }
  if (absent) {
    state.received = false;
    for (const SignalId signal : plans_[source].signals) {
      image_.values_[signal] = 0;
    }
    feeds_[source].written.reset();
    make_stale(source);
  }
  listener_.on_presence(source);
}

std::vector<alarms::DataProblem> Inputs::problems() const {
  std::vector<alarms::DataProblem> found;
  for (const Feed& feed : feeds_) {
    if (feed.problem) {
      found.push_back(*feed.problem);
    }
  }
  return found;
}

std::optional<alarms::DataProblem> Inputs::problem_of(SourceId source) const {
  const Feed& feed = feeds_[source];
  if (is_tpdo(source)) {
    // One on change that came is good whether SDO reads it or not.
    const bool unread_is_well = !is_cyclic(source) && feed.told_fresh;
    return feed.tpdo.problem(unread_is_well ? std::nullopt : feed.round.failure());
  }
  if (!image_.sources()[source].absent) {
    return std::nullopt;
  }
  std::string names;
  for (const SourcePlan::Word& word : plans_[source].words) {
    names += (names.empty() ? "" : ", ") + model_.signals[word.signal].name;
  }
  return alarms::DataProblem{
      alarms::DataReason::absent,
      "the drive has no object " + to_string(plans_[source].objects.front().address) + " (" + names + ")"};
}

void Inputs::update_problem(SourceId source) {
  std::optional<alarms::DataProblem> problem = problem_of(source);
  if (problem != feeds_[source].problem) {
    feeds_[source].problem = std::move(problem);
    listener_.on_problems();
  }
}

void Inputs::note_looked_at(SourceId source) {
  if (!std::exchange(feeds_[source].looked_at, true)) {
    update_examined();
  }
}

bool Inputs::examined() const noexcept {
  for (SourceId source = 0; source < source_count(); ++source) {
    // While it is not operational nothing is wrong with a TPDO that does not come.
    if (!feeds_[source].looked_at && (operational_ || !is_tpdo(source))) {
      return false;
    }
  }
  return online_;
}

void Inputs::update_examined() {
  if (!std::exchange(told_examined_, examined()) && told_examined_) {
    listener_.on_problems();
  }
}

}  // namespace process
