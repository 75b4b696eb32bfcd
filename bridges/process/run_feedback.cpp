#include "bridges/process/run_feedback.h"

namespace process {

void RunFeedback::on_confirmed(ControlUse use, canopen::TimePoint now) {
  if (use == ControlUse::stop) {
    end();
  } else if (use == ControlUse::run && feedback_ > canopen::Duration::zero() && due_ == canopen::kNever) {
    due_ = now + feedback_;
  }
}

void RunFeedback::on_running(std::optional<bool> running, canopen::TimePoint now) {
  // Only where it begins to turn: a motor that was still running down from before follows nothing.
  const bool began = running == true && running_ != true;
  running_ = running;
  if (began) {
    end();
  }
  expire(now);
}

void RunFeedback::expire(canopen::TimePoint now) {
  if (running_ && now >= due_) {
    failed_ = !*running_;
    due_ = canopen::kNever;
  }
}

void RunFeedback::end() noexcept {
  due_ = canopen::kNever;
  failed_ = false;
}

}  // namespace process
