#include "bridges/process/control.h"

#include <algorithm>
#include <utility>

#include "config/text.h"

namespace process {

void Control::on_accepted(const Writer& writer, ControlUse use, canopen::TimePoint now) {
  lease_.on_accepted(writer, use, now);
  timeout_.on_accepted(writer, use, now);
}

void Control::on_confirmed_control(const Writer& writer, ControlUse use, canopen::TimePoint now) {
  timeout_.on_confirmed(writer, use, now);
  feedback_.on_confirmed(use, now);
}

void Control::on_running(std::optional<bool> running, canopen::TimePoint now) {
  timeout_.on_running(running);
  feedback_.on_running(running, now);
}

void Control::on_session_end() {
  timeout_.on_session_end();
  feedback_.on_session_end();
}

CommandTimeout::Action Control::expire(canopen::TimePoint now) {
  lease_.expire(now);
  feedback_.expire(now);
  return timeout_.expire(now);
}

void Control::on_values_failed(std::string why, canopen::TimePoint now) {
  timeout_.on_values_failed(std::move(why), now);
}

canopen::TimePoint Control::next_time() const noexcept {
  return std::min({lease_.until(), timeout_.next_time(), feedback_.next_time()});
}

ControlState Control::state() const {
  return {.holder = lease_.holder(), .since = lease_.since(), .timeout = timeout_.acted(), .alarm = alarm()};
}

std::optional<alarms::ControlAlarm> Control::alarm() const {
  if (auto acted = timeout_.alarm()) {
    return acted;
  }
  if (!feedback_.failed()) {
    return std::nullopt;
  }
  return alarms::ControlAlarm{
      .reason = alarms::ControlReason::feedback,
      .text = "running is still false " + config::to_text(feedback_time_) + " after a confirmed run command"};
}

}  // namespace process
