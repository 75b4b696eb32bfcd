#include "simulator/receive_pdo.h"

#include <chrono>
#include <utility>

namespace simulator {

ReceivePdo::ReceivePdo(std::uint8_t number, PdoContext& context)
    : number_(number), context_(context), deadline_(context.executor, [this] { context_.deadline_missed(number_); }) {}

void ReceivePdo::stop() {
  held_.reset();
  deadline_.stop();
}

void ReceivePdo::apply_settings() {
  held_.reset();
  if (deadline_.running()) {
    deadline_.stop();
    if (settings_.enabled() && settings_.event != 0) {
      deadline_.start(std::chrono::milliseconds(settings_.event));
    }
  }
}

bool ReceivePdo::length_is_right(const canopen::Frame& frame) {
  const std::uint8_t exact = context_.rules.exact_length[number_ - 1U];
  const std::uint8_t needed = mapped_bytes(settings_);
  const bool too_short = frame.size < needed;
  if (too_short || (exact != 0 && frame.size != exact)) {
    ++context_.record.rpdo_length_errors;
    context_.length_error(number_, !too_short);
    return false;
  }
  if (frame.size > needed && exact == 0 && context_.rules.length_errors) {
    // CiA 301 §7.2.2.5: the mapped bytes are used, the surplus is reported.
    ++context_.record.rpdo_length_errors;
    context_.length_error(number_, true);
  } else {
    context_.length_right(number_);
  }
  return true;
}

bool ReceivePdo::on_frame(const canopen::Frame& frame) {
  if (settings_.count == 0 || !length_is_right(frame)) {
    return false;
  }
  ++context_.record.rpdos[number_ - 1U];
  if (context_.rules.rpdo_deadline && settings_.event != 0) {
    deadline_.start(std::chrono::milliseconds(settings_.event));
  }
  if (context_.rules.rpdo_waits_for_sync && settings_.type <= 240) {
    held_ = frame;
    return false;
  }
  take(frame);
  return true;
}

bool ReceivePdo::on_sync() {
  if (!held_) {
    return false;
  }
  const canopen::Frame frame = *std::exchange(held_, std::nullopt);
  take(frame);
  return true;
}

void ReceivePdo::take(const canopen::Frame& frame) {
  if (context_.local()) {
    return;
  }
  unpack(context_.dictionary, settings_, frame);
  context_.received(number_, frame);
}

}  // namespace simulator
