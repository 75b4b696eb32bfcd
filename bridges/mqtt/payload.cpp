#include "bridges/mqtt/payload.h"

#include <optional>

#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"

namespace mqtt {
namespace {

void append_values(std::string& out, const process::Drive& drive, const Pace& pace,
                   std::optional<canopen::TimePoint> now) {
  const config::Drive& model = drive.model();
  const process::Image& image = drive.image();
  text::ObjectText object(out);
  for (std::size_t i = 0; i < model.signals.size(); ++i) {
    const config::Signal& signal = model.signals[i];
    if (!config::readable(signal.access)) {
      continue;
    }
    const auto id = static_cast<process::SignalId>(i);
    const auto raw = now && image.fresh(id, *now) ? std::optional(image.raw(id)) : std::nullopt;
    append_member(object, signal, pace.shape(id), raw);
    // A word with names has its number beside it, unless a signal of that name exists.
    if (pace.shape(id) == Shape::name && !model.find(signal.name + "_code")) {
      object.key(signal.name + "_code") += raw ? integer_text(signal.type, *raw) : "null";
    }
  }
  object.close();
}

}  // namespace

std::optional<canopen::WallTime> newest_value(std::span<const process::SourceState> sources) {
  const process::SourceState* newest = nullptr;
  for (const process::SourceState& source : sources) {
    // Also what came before the drive was lost or rebooted: time does not go back because values do not count any more.
    if (source.at != canopen::TimePoint{} && (newest == nullptr || source.at > newest->at)) {
      newest = &source;
    }
  }
  return newest == nullptr ? std::nullopt : std::optional(newest->wall);
}

std::string state_json(const process::Drive& drive, const Pace& pace, std::optional<canopen::TimePoint> now) {
  std::string out;
  out.reserve(128 + 32 * drive.model().signals.size());
  const auto ts = newest_value(drive.image().sources());
  text::ObjectText object(out);
  object.text("ts", ts ? std::optional(text::timestamp(*ts)) : std::nullopt);
  object.boolean("online", now && drive.status().online);
  object.text("nmt", canopen::name_of(now ? drive.status().nmt_now() : canopen::NmtState::unknown));
  object.boolean("fresh", now && drive.image().all_fresh(*now));
  append_values(object.key("values"), drive, pace, now);
  object.close();
  return out;
}

std::optional<std::string> signal_text(const process::Drive& drive, process::SignalId signal, Shape shape,
                                       canopen::TimePoint now) {
  std::string text;
  const process::Image& image = drive.image();
  if (!image.fresh(signal, now) || !append_value(text, drive.model().signals[signal], shape, image.raw(signal))) {
    return std::nullopt;
  }
  return text;
}

std::string control_json(const process::ControlState& control) {
  std::string payload;
  text::ObjectText object(payload);
  object.text("holder", control.holder ? std::optional(process::to_string(*control.holder)) : std::nullopt);
  object.text("since", control.holder ? std::optional(text::timestamp(control.since)) : std::nullopt);
  object.boolean("timeout", control.timeout);
  object.close();
  return payload;
}

}  // namespace mqtt
