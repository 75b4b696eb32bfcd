#include "bridges/process/command_timeout.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "config/text.h"

namespace process {
namespace {

using namespace std::chrono_literals;

constexpr canopen::Duration kTryAgain = 1s;

// Where the loop comes this late the process stood still, and signs of life may wait in sockets: those are read first.
constexpr canopen::Duration kLate = 50ms;
constexpr canopen::Duration kSecondLook = 20ms;

}  // namespace

void CommandTimeout::watch(std::optional<Writer> writer, canopen::TimePoint alive) {
  counting_ = true;
  watched_ = std::move(writer);
  alive_ = alive;
  second_look_.reset();
}

void CommandTimeout::on_accepted(const Writer& writer, ControlUse use, canopen::TimePoint now) {
  if (timeout_ == canopen::Duration::zero()) {
    return;
  }
  on_sign_of_life(writer, now);
  if (use == ControlUse::none) {
    return;
  }
  std::erase_if(signs_, [&](const Sign& sign) { return sign.writer == writer || now - sign.at >= timeout_; });
  signs_.push_back({.writer = writer, .at = now});
  if (!acted_) {
    return;
  }
  acted_ = false;
  values_ = Values::none;
  if (may_run_) {
    watch(writer, now);
  }
}

void CommandTimeout::on_confirmed(const Writer& writer, ControlUse use, canopen::TimePoint now) {
  if (timeout_ == canopen::Duration::zero() || use == ControlUse::none) {
    return;
  }
  taken_over_.reset();
  may_run_ = use != ControlUse::stop;
  counting_ = false;
  if (may_run_) {
    const auto sign = std::ranges::find(signs_, writer, &Sign::writer);
    watch(writer, sign == signs_.end() ? now - timeout_ : sign->at);  // forgotten: silent for longer than that
  }
}

void CommandTimeout::on_sign_of_life(const Writer& writer, canopen::TimePoint now) {
  const auto sign = std::ranges::find(signs_, writer, &Sign::writer);
  if (sign != signs_.end()) {
    sign->at = now;
  }
  if (counting_ && (!watched_ || *watched_ == writer)) {
    watch(watched_, now);
  }
}

void CommandTimeout::on_taken_over(std::optional<bool> running, canopen::TimePoint now) {
  if (timeout_ == canopen::Duration::zero()) {
    return;
  }
  taken_over_ = now;
  on_running(running);
}

void CommandTimeout::on_running(std::optional<bool> running) {
  if (!running) {
    return;
  }
  if (!*running && !watched_) {
    may_run_ = counting_ = false;
  }
  if (*running && taken_over_) {
    watch(std::nullopt, *taken_over_);
    may_run_ = true;
    counting_ = !acted_;
  }
  taken_over_.reset();
}

void CommandTimeout::on_session_end() {
  may_run_ = counting_ = false;
  taken_over_.reset();
  if (values_ == Values::wanted) {
    values_ = Values::given_up;
  }
}

canopen::TimePoint CommandTimeout::due() const noexcept {
  return second_look_.value_or(alive_ + timeout_);
}

CommandTimeout::Action CommandTimeout::expire(canopen::TimePoint now) {
  if (counting_ && now >= due()) {
    if (!second_look_ && now - due() > kLate) {
      second_look_ = now + kSecondLook;
      return Action::none;
    }
    counting_ = false;
    acted_ = true;
    silent_ = watched_ ? to_string(*watched_) : "any writer";
    if (on_timeout_ != OnTimeout::values) {
      return on_timeout_ == OnTimeout::cease ? Action::cease : Action::none;
    }
    values_ = Values::wanted;
    ++occasion_;
    why_.clear();
    try_at_ = now;
  }
  if (values_ != Values::wanted || tried_for_ || now < try_at_) {
    return Action::none;
  }
  tried_for_ = occasion_;
  tried_at_ = now;
  return Action::write_values;
}

void CommandTimeout::on_values_confirmed() {
  if (std::exchange(tried_for_, std::nullopt) == occasion_ && values_ == Values::wanted) {
    values_ = Values::confirmed;
  }
}

void CommandTimeout::on_values_failed(std::string why, canopen::TimePoint now) {
  if (std::exchange(tried_for_, std::nullopt) != occasion_) {
    return;
  }
  why_ = std::move(why);
  try_at_ = std::max(tried_at_ + kTryAgain, now);
}

canopen::TimePoint CommandTimeout::next_time() const noexcept {
  const canopen::TimePoint silence = counting_ ? due() : canopen::kNever;
  const canopen::TimePoint attempt = values_ == Values::wanted && !tried_for_ ? try_at_ : canopen::kNever;
  return std::min(silence, attempt);
}

std::optional<alarms::ControlAlarm> CommandTimeout::alarm() const {
  if (!acted_) {
    return std::nullopt;
  }
  const bool failed = values_ == Values::given_up || (values_ == Values::wanted && !why_.empty());
  return alarms::ControlAlarm{.reason = failed ? alarms::ControlReason::timeout_failed : alarms::ControlReason::timeout,
                              .text = text()};
}

std::string CommandTimeout::text() const {
  const std::string silence = "no sign of life of " + silent_ + " for " + config::to_text(timeout_);
  if (on_timeout_ == OnTimeout::hold) {
    return silence + ": the drive goes on";
  }
  if (on_timeout_ == OnTimeout::cease) {
    return silence + ": RPDOs are repeated no more";
  }
  switch (values_) {
    case Values::confirmed:
      return silence + ": its values were written";
    case Values::given_up:
      return silence + ": its values are not confirmed, and given up since the drive was lost or left operational";
    case Values::wanted:
    case Values::none:
      break;
  }
  return silence + (why_.empty() ? ": its values are being written" : ": its values are not confirmed: " + why_);
}

}  // namespace process
