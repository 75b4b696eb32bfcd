#include "bridges/journal/journal.h"

#include <optional>
#include <utility>

#include "bridges/journal/record_text.h"
#include "canopen/clock.h"

namespace journal {
namespace {

using process::CommandRecord;

// Clients that change their address or their signals all the time make so many kinds at most, and one more for each
// outcome: all further ones together.
constexpr std::size_t kMaxKinds = 1000;

std::string name_of(const CommandRecord& record) {
  return who_text(record) + ' ' + record.id;
}

std::string signals_of(const CommandRecord& record) {
  std::string text;
  for (const process::FieldRecord& field : record.fields) {
    text += ' ' + std::to_string(field.signal);
  }
  return text;
}

// What makes two commands one kind, of which there is one line a minute; nothing: it has its own line. What may have
// moved a motor or changed a setting always has.
std::optional<std::string> kind_of(const CommandRecord& record, const process::Outcome& outcome,
                                   const std::string& who) {
  const bool set_points = record.kind == CommandRecord::Kind::write && !record.writes_control;
  const bool refused = outcome.has_error() && !outcome.error().outcome_unknown && outcome.written == 0;
  if (refused) {
    return who;
  }
  return set_points ? std::optional(who + signals_of(record)) : std::nullopt;
}

}  // namespace

Journal::Journal(const boost::asio::any_io_executor& executor, const Place& place, disk::Trouble::Told told)
    : queue_(executor, place, std::move(told)), minute_(executor, [this] { on_minute(); }) {}

boost::asio::awaitable<void> Journal::stop() {
  for (Entry& line : repeats_.take_all()) {
    queue_.post(std::move(line));
  }
  co_await queue_.until_synced(canopen::Clock::now() + std::chrono::seconds(1));
}

boost::asio::awaitable<void> Journal::begun(const CommandRecord& record) {
  begun_.insert(name_of(record));
  const std::uint64_t number = queue_.post({canopen::wall_now(), canopen::Clock::now(),
                                            "\"phase\":\"begun\"," + who_text(record) + ',' + what_text(record)});
  co_await queue_.written(number);
}

void Journal::done(const CommandRecord& record, const process::Outcome& outcome) {
  const canopen::TimePoint now = canopen::Clock::now();
  const std::string code = "\"outcome\":\"" + code_of(outcome) + '"';
  std::string who = who_text(record) + ',' + code;
  const auto begun = begun_.find(name_of(record));
  auto kind = begun == begun_.end() ? kind_of(record, outcome, who) : std::nullopt;
  if (begun != begun_.end()) {
    begun_.erase(begun);
  }
  Ended ended{canopen::wall_now(), now, std::move(who), what_text(record) + ',' + result_text(record, outcome, now)};
  if (!kind) {
    queue_.post(line_of(ended));
    return;
  }
  if (repeats_.size() >= kMaxKinds && !repeats_.knows(*kind)) {
    kind = code;
    ended.who = code;
    ended.what = who_text(record) + ',' + ended.what;
  }
  if (auto line = repeats_.add(*kind, std::move(ended))) {
    queue_.post(*std::move(line));
  }
  minute_.arm_no_later_than(repeats_.due());
}

void Journal::on_minute() {
  for (Entry& line : repeats_.take_due(canopen::Clock::now())) {
    queue_.post(std::move(line));
  }
  if (repeats_.due() != canopen::kNever) {
    minute_.arm(repeats_.due());
  }
}

}  // namespace journal
