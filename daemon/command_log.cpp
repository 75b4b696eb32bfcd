#include "daemon/command_log.h"

#include <spdlog/fmt/fmt.h>

#include <chrono>
#include <string_view>
#include <utility>

#include "bridges/process/answer.h"

namespace gateway {
namespace {

using process::CommandRecord;
using process::FieldRecord;
using process::Outcome;

/// A client that polls what it is refused does so for hours.
constexpr canopen::Duration kPauseOfPolled = std::chrono::minutes(1);
constexpr canopen::Duration kPause = std::chrono::seconds(1);
/// Clients that change their address all the time make so many at most; all further ones are told together.
constexpr std::size_t kMaxKinds = 1000;

std::string field_text(const config::Drive& drive, const FieldRecord& field) {
  if (field.signal >= drive.signals.size()) {
    return "no signal";
  }
  const config::Signal& signal = drive.signals[field.signal];
  if (!field.asked) {
    return field.given ? fmt::format("{} {}", signal.name, *field.given) : signal.name + " (no value)";
  }
  const double number = canopen::to_number(signal.type, *field.asked) * signal.scale;
  std::string text = fmt::format("{} {:.{}f}", signal.name, number, signal.decimals);
  return signal.unit.empty() ? text : text + " " + signal.unit;
}

std::string what_of(const CommandRecord& record) {
  if (record.kind == CommandRecord::Kind::nmt) {
    return record.nmt ? "NMT " + std::string(canopen::name_of(*record.nmt)) : "NMT (no command)";
  }
  if (record.kind == CommandRecord::Kind::raw) {
    if (record.object && !record.bytes.empty()) {
      return fmt::format("object {}, {} bytes", canopen::to_string(record.object->object), record.bytes.size());
    }
    return record.object ? fmt::format("object {} = {}", canopen::to_string(record.object->object), record.object->raw)
                         : "object (no request)";
  }
  std::string text;
  for (const FieldRecord& field : record.fields) {
    text += (text.empty() ? "" : ", ") + field_text(*record.drive, field);
  }
  return text.empty() ? "nothing" : text;
}

std::string outcome_text(const CommandRecord& record, const Outcome& outcome, canopen::TimePoint now) {
  const auto taken = std::chrono::duration_cast<std::chrono::milliseconds>(now - record.arrived).count();
  if (outcome.has_value()) {
    std::string text = fmt::format("ok{} in {} ms", outcome.unchanged ? ", unchanged," : "", taken);
    return outcome.note.empty() ? text : text + ", " + outcome.note;
  }
  const canopen::Error& failure = outcome.error();
  const bool refused = !failure.outcome_unknown && failure.kind != canopen::ErrorKind::refused;
  return fmt::format("{}{}, after {} ms", refused ? "refused " : "", canopen::to_string(failure), taken);
}

/// Nothing of it reached the drive.
bool nothing_sent(const Outcome& outcome) {
  return outcome.has_error() && outcome.written == 0 && !outcome.error().outcome_unknown &&
         outcome.error().kind != canopen::ErrorKind::refused;
}

/// Of what there may be very many, what it is called, and how long the next line waits; empty: told always.
std::pair<std::string, canopen::Duration> pace_of(const CommandRecord& record, const Outcome& outcome) {
  if (nothing_sent(outcome)) {
    return {"refused " + std::string(process::answer_of(outcome.error().kind).mqtt_code),
            record.writer.way == process::Writer::Way::modbus ? kPauseOfPolled : kPause};
  }
  const bool set_points = record.kind == CommandRecord::Kind::write && !record.writes_control;
  return {set_points ? "set-points" : "", kPause};
}

}  // namespace

void CommandLog::on_done(const CommandRecord& record, const Outcome& outcome, canopen::TimePoint now) {
  const std::string writer = process::to_string(record.writer);
  const auto [name, pause] = pace_of(record, outcome);
  Kind kind{record.drive->name, writer, name};
  if (paced_.size() >= kMaxKinds && !paced_.contains(kind)) {
    kind = {"all drives", "other writers", name};
  }
  end_pauses(kind, now);
  std::string more;
  if (!name.empty()) {
    const auto [paced, is_new] = paced_.try_emplace(kind, Paced{.until = now + pause});
    if (!is_new && now < paced->second.until) {
      ++paced->second.left_out;
      return;
    }
    paced->second.until = now + pause;
    if (const std::size_t left_out = std::exchange(paced->second.left_out, 0); left_out > 0) {
      more = fmt::format(", and {} before it", left_out);
    }
  }
  write_(fmt::format("{}: {}: {}: {} (id {}{})", record.drive->name, writer, what_of(record),
                     outcome_text(record, outcome, now), record.id, more));
}

/// What was left out of other kinds, whose pause is over.
void CommandLog::end_pauses(const Kind& but, canopen::TimePoint now) {
  for (auto paced = paced_.begin(); paced != paced_.end();) {
    if (paced->first == but || now < paced->second.until) {
      ++paced;
      continue;
    }
    if (paced->second.left_out > 0) {
      const auto& [drive, writer, what] = paced->first;
      write_(fmt::format("{}: {}: {} more: {}", drive, writer, paced->second.left_out, what));
    }
    paced = paced_.erase(paced);
  }
}

}  // namespace gateway
