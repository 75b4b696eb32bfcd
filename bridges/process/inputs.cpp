#include "bridges/process/inputs.h"

#include <algorithm>
#include <utility>

namespace process {
namespace {

using canopen::Duration;
using canopen::TimePoint;

/// An on-change TPDO is usually sent at the start by itself; reading at once would only double it.
constexpr Duration kFirstRead = std::chrono::milliseconds(100);
using canopen::kNever;
constexpr TimePoint kStale = TimePoint::min();

}  // namespace

Inputs::Inputs(const config::Drive& model, Image& image, Verified verified, Listener& listener)
    : model_(model), image_(image), verified_(std::move(verified)), listener_(listener), plans_(plan_sources(model)) {
  feeds_.reserve(plans_.size());
  for (const SourcePlan& plan : plans_) {
    feeds_.emplace_back(plan);
  }
}

void Inputs::on_status(bool online, bool operational, TimePoint now) {
  const bool was_online = std::exchange(online_, online);
  const bool was_operational = std::exchange(operational_, operational);
  if (was_online != online) {
    for (SourceId source = 0; source < source_count(); ++source) {
      feeds_[source].looked_at = false;
      if (!is_tpdo(source)) {
        feeds_[source].round.cancel();
        if (online) {
          feeds_[source].round.schedule(now);
        }
      }
    }
  }
  const bool was_live = was_online && was_operational;
  if (live() && !was_live) {
    begin_life(now);
  } else if (!live() && was_live) {
    end_life();
  }
  if (online && !was_online) {
    listener_.on_read_wanted();
  }
  update_examined();
}

void Inputs::begin_life(TimePoint now) {
  for (SourceId source = 0; source < source_count(); ++source) {
    if (is_tpdo(source)) {
      reset_tpdo(source);
      feeds_[source].tpdo.begin(now);
      if (!is_cyclic(source)) {
        feeds_[source].round.schedule(now + kFirstRead);
      }
    }
  }
  listener_.on_read_wanted();
}

void Inputs::end_life() {
  for (SourceId source = 0; source < source_count(); ++source) {
    if (is_tpdo(source)) {
      reset_tpdo(source);
    }
  }
}

void Inputs::on_boot_up() {
  for (SourceId source = 0; source < source_count(); ++source) {
    if (is_tpdo(source)) {
      reset_tpdo(source);
    } else {
      image_.sources_[source].received = false;
      make_stale(source);
    }
  }
}

void Inputs::reset_tpdo(SourceId source) {
  Feed& feed = feeds_[source];
  image_.sources_[source].received = false;
  feed.tpdo.end();
  feed.round.cancel();
  feed.watched = false;
  make_stale(source);
  update_problem(source);
}

void Inputs::make_stale(SourceId source) {
  image_.sources_[source].fresh_until = kStale;
  if (std::exchange(feeds_[source].told_fresh, false)) {
    listener_.on_stale(source);
  }
}

void Inputs::on_tpdo(std::uint16_t number, std::span<const canopen::Raw> values, TimePoint at, canopen::WallTime wall) {
  const std::optional<SourceId> source = find_tpdo(number);
  if (!source || values.size() != plans_[*source].values) {
    return;
  }
  TimePoint fresh_until = kStale;
  if (live()) {
    note_frame(*source, at);
    fresh_until = is_cyclic(*source) ? at + kFreshPeriods * plans_[*source].period : kNever;
    if (feeds_[*source].tpdo.substituted()) {
      // Reading goes on beside a TPDO that comes now and then, and its own freshness holds.
      fresh_until = std::max(fresh_until, image_.sources_[*source].fresh_until);
    }
  }
  apply(*source, values, at, wall, fresh_until);
  note_looked_at(*source);
}

void Inputs::note_frame(SourceId source, TimePoint at) {
  Feed& feed = feeds_[source];
  feed.tpdo.on_frame(at);
  if (feed.round.due() != kNever) {
    // What was read before this frame is older than the frame.
    feed.round.cancel();
    if (reads_regularly(source)) {
      feed.round.schedule_next(at);
    }
  }
  if (feed.problem) {
    update_problem(source);
  }
}

void Inputs::apply(SourceId source, std::span<const canopen::Raw> values, TimePoint at, canopen::WallTime wall,
                   TimePoint fresh_until) {
  const SourcePlan& plan = plans_[source];
  for (const SourcePlan::Word& word : plan.words) {
    image_.values_[word.signal] = canopen::normalise(model_.signals[word.signal].type, values[word.position]);
  }
  derive(plan);
  SourceState& state = image_.sources_[source];
  state.absent = false;
  state.received = live() || !is_tpdo(source);
  state.at = at;
  state.wall = wall;
  state.fresh_until = fresh_until;
  feeds_[source].told_fresh = state.received && fresh_until != kStale;
  listener_.on_values(source);
}

void Inputs::derive(const SourcePlan& plan) noexcept {
  for (const SignalId signal : plan.derived) {
    const config::Derived& rule = *model_.signals[signal].derived;
    const canopen::Raw word = image_.values_[rule.from];
    const bool set = rule.negative
                         ? canopen::to_number(model_.signals[rule.from].type, word) < 0
                         : std::find(rule.values.begin(), rule.values.end(), word & rule.mask) != rule.values.end();
    image_.values_[signal] = set ? 1 : 0;
  }
}

void Inputs::on_tpdo_length(std::uint16_t number, std::size_t expected, std::size_t received, TimePoint now) {
  const std::optional<SourceId> source = find_tpdo(number);
  if (source && received < expected) {
    Feed& feed = feeds_[*source];
    const bool was_substituted = feed.tpdo.substituted();
    feed.tpdo.on_too_short(expected, received);
    if (feed.tpdo.substituted() && !was_substituted) {
      // What is shown is what held before it.
      make_stale(*source);
      feed.round.cancel();
      feed.round.schedule(now);
      listener_.on_read_wanted();
    }
    update_problem(*source);
    note_looked_at(*source);
  } else if (source && !std::exchange(feeds_[*source].told_longer, true)) {
    listener_.on_remark("TPDO" + std::to_string(number) + " has " + std::to_string(received) + " bytes, expected " +
                        std::to_string(expected) + "; the first ones count");
  }
}

void Inputs::on_frames_lost(TimePoint now) {
  if (!live()) {
    return;
  }
  for (SourceId source = 0; source < source_count(); ++source) {
    if (!is_tpdo(source)) {
      continue;
    }
    make_stale(source);
    if (!is_cyclic(source) || feeds_[source].tpdo.substituted()) {
      feeds_[source].round.cancel();
      feeds_[source].round.schedule(now);
    }
  }
  listener_.on_read_wanted();
}

TimePoint Inputs::next_expiry() const noexcept {
  TimePoint next = kNever;
  for (SourceId source = 0; source < source_count(); ++source) {
    const Feed& feed = feeds_[source];
    if (feed.told_fresh) {
      next = std::min(next, image_.sources_[source].fresh_until);
    }
    next = std::min(next, feed.tpdo.due());
  }
  // A value is fresh up to and including its last moment.
  return next == kNever ? kNever : next + Duration(1);
}

void Inputs::expire(TimePoint now) {
  for (SourceId source = 0; source < source_count(); ++source) {
    Feed& feed = feeds_[source];
    if (now > feed.tpdo.due()) {
      const bool was_substituted = feed.tpdo.substituted();
      feed.tpdo.expire(now, verified_(plans_[source].source.number));
      if (feed.tpdo.substituted() && !was_substituted) {
        feed.round.schedule(now);
        listener_.on_read_wanted();
      }
      update_problem(source);
      note_looked_at(source);
    }
    if (feed.told_fresh && now > image_.sources_[source].fresh_until) {
      make_stale(source);
    }
  }
}

Duration Inputs::period_of(SourceId source) const noexcept {
  return is_cyclic(source) ? plans_[source].period : plans_[source].poll;
}

bool Inputs::is_tpdo(SourceId source) const noexcept {
  return plans_[source].source.kind == config::SourceKind::tpdo;
}

bool Inputs::is_cyclic(SourceId source) const noexcept {
  return plans_[source].period > Duration::zero();
}

std::optional<SourceId> Inputs::find_tpdo(std::uint16_t number) const noexcept {
  for (SourceId source = 0; source < source_count(); ++source) {
    if (is_tpdo(source) && plans_[source].source.number == number) {
      return source;
    }
  }
  return std::nullopt;
}

}  // namespace process
