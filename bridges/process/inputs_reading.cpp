// Which objects Inputs wants read by SDO, and what their answers mean.

#include <algorithm>
#include <utility>

#include "bridges/process/inputs.h"

namespace process {
namespace {

using canopen::Duration;
using canopen::TimePoint;

/// Pause before an object is asked for again that the drive does not have or does not show: a parameter may make it
/// appear.
constexpr Duration kAbsentObject = std::chrono::seconds(60);

/// One that does not answer keeps the SDO channel through all its tries, and commands wait behind it.
constexpr Duration kSilentObject = std::chrono::seconds(10);

using canopen::kNever;

std::string integer_text(canopen::DataType type, canopen::Raw raw) {
  return canopen::is_signed(type) ? std::to_string(static_cast<std::int64_t>(raw)) : std::to_string(raw);
}

bool is_never_read(const canopen::Error& error) {
  // CiA 301 table 22: no read access.
  return canopen::is_absent(error) ||
         (error.kind == canopen::ErrorKind::refused && (error.abort == 0x06010000 || error.abort == 0x06010001));
}

Duration pause_after(const canopen::Error& error, Duration poll) {
  if (is_never_read(error)) {
    return std::max(kAbsentObject, poll);
  }
  return error.kind == canopen::ErrorKind::timeout ? std::max(kSilentObject, poll) : poll;
}

}  // namespace

TimePoint Inputs::next_read_at() const noexcept {
  TimePoint next = kNever;
  for (const Feed& feed : feeds_) {
    next = std::min(next, feed.round.due());
  }
  return next;
}

std::optional<ReadJob> Inputs::next_read(TimePoint now) {
  const auto first = std::min_element(feeds_.begin(), feeds_.end(),
                                      [](const Feed& a, const Feed& b) { return a.round.due() < b.round.due(); });
  if (first == feeds_.end() || first->round.due() > now) {
    return std::nullopt;
  }
  const TimePoint due = first->round.due();
  first->round.note_begin(now);
  const SourcePlan::Object& object = first->round.object();
  return ReadJob{static_cast<SourceId>(first - feeds_.begin()), object.address, object.type, first->round.id(), due};
}

void Inputs::on_read(const ReadJob& job, const canopen::Result<canopen::Raw>& answer, TimePoint at,
                     canopen::WallTime wall) {
  SdoRound& round = feeds_[job.source].round;
  if (round.id() != job.round) {
    return;
  }
  switch (round.store(answer)) {
    case SdoRound::Progress::goes_on:
      return;
    case SdoRound::Progress::complete:
      on_round_complete(job.source, at, wall);
      break;
    case SdoRound::Progress::failed:
      on_round_failed(job.source, answer.error(), at);
      break;
  }
  update_problem(job.source);
  // No answer is no proof of anything.
  if (answer.has_value() || answer.error().kind == canopen::ErrorKind::refused) {
    note_looked_at(job.source);
  }
}

void Inputs::on_round_complete(SourceId source, TimePoint at, canopen::WallTime wall) {
  SdoRound& round = feeds_[source].round;
  const bool told_by_itself = is_tpdo(source) && !is_cyclic(source) && !feeds_[source].tpdo.substituted();
  if (reads_regularly(source)) {
    round.schedule_next(at);
  }
  apply(source, round.values(), at, wall, told_by_itself ? kNever : at + kFreshPeriods * plans_[source].poll);
  if (const auto written = std::exchange(feeds_[source].written, std::nullopt)) {
    const SignalId signal = plans_[source].words.front().signal;
    if (image_.raw(signal) != *written) {
      const canopen::DataType type = model_.signals[signal].type;
      listener_.on_remark(model_.signals[signal].name + " was written and confirmed as " +
                          integer_text(type, *written) + ", but the drive holds " +
                          integer_text(type, image_.raw(signal)) + " (raw)");
    }
  }
}

void Inputs::on_written(SignalId signal, canopen::Raw raw, TimePoint at, canopen::WallTime wall) {
  const SourceState* state = image_.source_of(signal);
  if (state == nullptr) {
    return;
  }
  const auto source = static_cast<SourceId>(state - image_.sources().data());
  // A TPDO tells by itself.
  if (is_tpdo(source) || !online_) {
    return;
  }
  Feed& feed = feeds_[source];
  feed.written = raw;
  feed.round.cancel();  // What is being read is older.
  feed.round.schedule(TimePoint{});
  const std::vector<canopen::Raw> values(plans_[source].values, raw);
  apply(source, values, at, wall, at + kFreshPeriods * plans_[source].poll);
  update_problem(source);
  listener_.on_read_wanted();
}

void Inputs::on_round_failed(SourceId source, const canopen::Error& error, TimePoint at) {
  if (!is_tpdo(source) && error.kind == canopen::ErrorKind::refused) {
    set_absent(source, canopen::is_absent(error));
  }
  const bool waits_for_first = is_tpdo(source) && !is_cyclic(source) && !feeds_[source].told_fresh;
  if (reads_regularly(source) || waits_for_first) {
    feeds_[source].round.schedule_retry(at, pause_after(error, plans_[source].poll));
  }
  if (feeds_[source].watched) {
    listener_.on_watch_failed(source);
  }
}

bool Inputs::reads_regularly(SourceId source) const noexcept {
  if (!is_tpdo(source)) {
    return online_;
  }
  return live() && (feeds_[source].tpdo.substituted() || feeds_[source].watched);
}

void Inputs::watch(SourceId source, bool watched, TimePoint now) {
  if (!is_tpdo(source) || is_cyclic(source) || feeds_[source].watched == watched) {
    return;
  }
  feeds_[source].watched = watched;
  if (watched && live()) {
    feeds_[source].round.schedule(now + plans_[source].poll);
    listener_.on_read_wanted();
  }
}

}  // namespace process
