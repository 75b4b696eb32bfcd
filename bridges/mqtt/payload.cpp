#include "bridges/mqtt/payload.h"

#include <optional>

#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"

namespace mqtt {
namespace {

// A word with names has its number beside it, unless a signal of that name exists.
std::optional<std::string> code_key(const config::Drive& model, const config::Signal& signal) {
  std::string key = signal.name + "_code";
  if (model.find(key)) {
    return std::nullopt;
  }
  return key;
}

void append_named(text::ObjectText& object, const config::Drive& model, const config::Signal& signal,
                  const std::string& text, canopen::Raw raw, bool fresh) {
  if (fresh) {
    object.text(signal.name, text);
  } else {
    object.null(signal.name);
  }
  const auto key = code_key(model, signal);
  if (!key) {
    return;
  }
  if (fresh) {
    object.key(*key) += integer_text(signal.type, raw);
  } else {
    object.null(*key);
  }
}

// Nothing is fresh without a time.
void append_values(std::string& out, const process::Drive& drive, const Pace& pace,
                   std::optional<canopen::TimePoint> now) {
  const config::Drive& model = drive.model();
  const process::Image& image = drive.image();
  text::ObjectText object(out);
  std::string text;
  for (std::size_t i = 0; i < model.signals.size(); ++i) {
    const config::Signal& signal = model.signals[i];
    if (!config::readable(signal.access)) {
      continue;
    }
    const auto id = static_cast<process::SignalId>(i);
    const Shape shape = pace.shape(id);
    text.clear();
    const bool fresh = now && image.fresh(id, *now) && append_value(text, signal, shape, image.raw(id));
    if (shape == Shape::name) {
      append_named(object, model, signal, text, image.raw(id), fresh);
    } else if (fresh) {
      object.key(signal.name) += text;
    } else {
      object.null(signal.name);
    }
  }
  object.close();
}

struct Head {
  bool online = false;
  canopen::NmtState nmt = canopen::NmtState::unknown;
  bool fresh = false;
};

std::string state_text(const process::Drive& drive, const Pace& pace, const Head& head,
                       std::optional<canopen::TimePoint> now) {
  std::string out;
  out.reserve(128 + 32 * drive.model().signals.size());
  text::ObjectText object(out);
  if (const auto ts = newest_value(drive.image().sources())) {
    object.text("ts", text::timestamp(*ts));
  } else {
    object.null("ts");
  }
  object.boolean("online", head.online);
  object.text("nmt", canopen::name_of(head.nmt));
  object.boolean("fresh", head.fresh);
  append_values(object.key("values"), drive, pace, now);
  object.close();
  return out;
}

}  // namespace

std::optional<canopen::WallTime> newest_value(std::span<const process::SourceState> sources) {
  const process::SourceState* newest = nullptr;
  for (const process::SourceState& source : sources) {
    if (source.received && (newest == nullptr || source.at > newest->at)) {
      newest = &source;
    }
  }
  return newest == nullptr ? std::nullopt : std::optional(newest->wall);
}

std::string state_json(const process::Drive& drive, const Pace& pace, canopen::TimePoint now) {
  const Head head{.online = drive.status().online, .nmt = drive.status().nmt, .fresh = drive.image().all_fresh(now)};
  return state_text(drive, pace, head, now);
}

std::string farewell_state_json(const process::Drive& drive, const Pace& pace) {
  return state_text(drive, pace, {}, std::nullopt);
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
  if (control.holder) {
    object.text("holder", process::to_string(*control.holder));
    object.text("since", text::timestamp(control.since));
  } else {
    object.null("holder");
    object.null("since");
  }
  object.boolean("timeout", control.timeout);
  object.close();
  return payload;
}

}  // namespace mqtt
