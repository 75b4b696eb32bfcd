#include "bridges/alarms/first_out.h"

#include <algorithm>
#include <utility>

namespace alarms {

FirstOut::FirstOut(Changed changed) : changed_(std::move(changed)) {}

void FirstOut::on_fault(const FaultSource& source, canopen::TimePoint at, bool first) {
  Shown& own = shown_[source];
  if (!first) {
    ++own.activation;  // What older groups gave it, its alarm does not show any more.
    own.firsts = 0;
    own.begun = at;
  } else if (own.firsts == 0) {
    own.firsts = 1;  // From before our start.
  }
  own.told = first;
  const auto group =
      std::find_if(groups_.begin(), groups_.end(), [at](const Group& one) { return at - one.end <= kWindow; });
  if (group == groups_.end() || group->begin - at > kWindow) {
    begin_group(group, source, at);
  } else {
    join(group, source, at);
  }
}

void FirstOut::begin_group(Groups::iterator before, const FaultSource& source, canopen::TimePoint at) {
  if (full_ && before == groups_.begin()) {
    return;  // Older than all that is remembered: nobody can tell.
  }
  give(*groups_.insert(before, Group{.first = source, .begin = at, .end = at}), source);
  if (groups_.size() > kMaxGroups) {
    groups_.erase(groups_.begin());
    full_ = true;
  }
  tell(source);
}

void FirstOut::join(Groups::iterator group, const FaultSource& source, canopen::TimePoint at) {
  const FaultSource replaced = group->first;
  if (at < group->begin) {
    take(*group);
    give(*group, source);
    group->begin = at;
  }
  group->end = std::max(group->end, at);
  std::optional<FaultSource> merged;
  if (const auto next = group + 1; next != groups_.end() && next->begin - group->end <= kWindow) {
    merged = next->first;
    take(*next);
    group->end = next->end;
    groups_.erase(next);
  }
  renew(*group);
  tell(replaced);
  tell(merged.value_or(source));
  tell(source);
}

std::optional<FaultSource> FirstOut::newest_group() const {
  return groups_.empty() ? restored_ : std::optional(groups_.back().first);
}

void FirstOut::restore(const FaultSource& newest) {
  restored_ = newest;
}

void FirstOut::move(const std::function<std::optional<FaultSource>(const FaultSource&)>& now_at) {
  std::map<FaultSource, Shown> moved;
  for (const auto& [source, shown] : shown_) {
    if (const auto now = now_at(source)) {
      moved.emplace(*now, shown);
    }
  }
  shown_ = std::move(moved);
  std::erase_if(groups_, [&now_at](const Group& group) { return !now_at(group.first); });
  for (Group& group : groups_) {
    group.first = now_at(group.first).value_or(group.first);
  }
  restored_ = restored_ ? now_at(*restored_) : std::nullopt;
}

void FirstOut::give(Group& group, const FaultSource& source) {
  Shown& shown = shown_[source];
  group.first = source;
  group.activation = shown.activation;
  ++shown.firsts;
}

void FirstOut::take(const Group& group) {
  Shown& shown = shown_[group.first];
  if (shown.activation == group.activation && shown.firsts > 0) {
    --shown.firsts;
  }
}

void FirstOut::renew(Group& group) {
  const Shown& shown = shown_[group.first];
  if (shown.activation != group.activation && shown.begun >= group.begin && shown.begun <= group.end) {
    give(group, FaultSource(group.first));
  }
}

void FirstOut::tell(const FaultSource& source) {
  Shown& shown = shown_.at(source);
  const bool first = shown.firsts > 0;
  if (std::exchange(shown.told, first) != first) {
    changed_(source, first);
  }
}

}  // namespace alarms
