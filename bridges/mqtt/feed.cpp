#include "bridges/mqtt/feed.h"

#include <algorithm>

#include "bridges/mqtt/expiry.h"
#include "bridges/mqtt/payload.h"

namespace mqtt {

Feed::Feed(const process::Drive& drive, const DriveTopics& topics, const config::Mqtt& settings)
    : drive_(drive),
      topics_(topics),
      settings_(settings),
      pace_(drive.model(), settings),
      status_(topics.status, settings) {
  mark_all();
}

canopen::TimePoint Feed::mark_values(std::span<const process::SignalId> signals, canopen::TimePoint now) {
  const process::Image& image = drive_.image();
  canopen::TimePoint due = canopen::TimePoint::max();
  for (const process::SignalId signal : signals) {
    due = std::min(due, pace_.note(signal, image.raw(signal), image.fresh(signal, now)));
  }
  // A source without a readable signal of its own cannot change `fresh` unseen: all_fresh() counts sources with
  // signals.
  if (settings_.state && image.all_fresh(now) != fresh_) {
    pace_.note_state();
    due = kAtOnce;
  }
  return due;
}

canopen::TimePoint Feed::mark_status(canopen::TimePoint now) {
  const canopen::NodeStatus& status = drive_.status();
  if (online_ == status.online && nmt_ == status.nmt_now()) {
    return canopen::TimePoint::max();  // counters and the result of the boot are on no topic
  }
  pace_.note_state();
  return now;
}

canopen::TimePoint Feed::mark_control(canopen::TimePoint now) {
  control_due_ = true;
  return now;
}

void Feed::mark_all() {
  status_.forget();
  online_.reset();
  nmt_.reset();
  control_due_ = true;
  pace_.forget();
}

canopen::TimePoint Feed::collect(canopen::TimePoint now, std::vector<Message>& out) {
  const bool online = drive_.status().online;
  status_.collect(online, now, out);
  online_ = online;
  if (control_due_) {
    control_due_ = false;
    out.push_back({.topic = topics_.control, .payload = control_json(drive_.control())});
  }
  // The state before the single values: its time stamps are those of the values as they were compared.
  collect_state(now, out);
  collect_signals(now, out);
  pace_.collected();
  return std::min(pace_.next(), status_.next());
}

void Feed::collect_last(std::vector<Message>& out) const {
  if (settings_.state) {
    out.push_back({.topic = topics_.state, .payload = state_json(drive_, pace_, std::nullopt)});
  }
  for (std::size_t i = 0; settings_.signals && i < topics_.signals.size(); ++i) {
    if (config::readable(drive_.model().signals[i].access)) {
      out.push_back({.topic = topics_.signals[i], .payload = settings_.stale_payload});
    }
  }
  out.push_back(status_.offline());
}

void Feed::collect_signals(canopen::TimePoint now, std::vector<Message>& out) {
  if (!settings_.signals) {
    return;
  }
  for (std::size_t i = 0; i < topics_.signals.size(); ++i) {
    const auto signal = static_cast<process::SignalId>(i);
    if (!pace_.signal_due(signal, now)) {
      continue;
    }
    const auto text = signal_text(drive_, signal, pace_.shape(signal), now);
    out.push_back({.topic = topics_.signals[i],
                   .payload = text.value_or(settings_.stale_payload),
                   .expiry = text ? expiry_of(settings_) : 0});
    const process::Image& image = drive_.image();
    pace_.published_signal(signal, image.raw(signal), image.fresh(signal, now), now);
  }
}

void Feed::collect_state(canopen::TimePoint now, std::vector<Message>& out) {
  if (!pace_.state_due(now)) {
    return;
  }
  out.push_back({.topic = topics_.state, .payload = state_json(drive_, pace_, now), .expiry = expiry_of(settings_)});
  const process::Image& image = drive_.image();
  nmt_ = drive_.status().nmt_now();
  fresh_ = image.all_fresh(now);
  if (!settings_.signals) {
    for (std::size_t i = 0; i < topics_.signals.size(); ++i) {
      const auto signal = static_cast<process::SignalId>(i);
      pace_.published_signal(signal, image.raw(signal), image.fresh(signal, now), now);
    }
  }
  pace_.published_state(now);
}

}  // namespace mqtt
