#include "simulator/transmit_pdo.h"

#include <algorithm>
#include <chrono>

namespace simulator {

TransmitPdo::TransmitPdo(std::uint8_t number, PdoContext& context)
    : number_(number),
      context_(context),
      event_(context.executor, [this] { request(); }),
      inhibit_(context.executor, [this] { end_inhibit(); }) {}

void TransmitPdo::start() {
  running_ = true;
  last_.reset();
  apply_settings();
}

void TransmitPdo::stop() {
  running_ = false;
  waiting_ = false;
  event_.stop();
  inhibit_.stop();
}

void TransmitPdo::apply_settings() {
  event_.stop();
  inhibit_.stop();
  waiting_ = false;
  syncs_ = 0;
  sync_started_ = false;
  sample_.reset();
  const auto triggers = context_.rules.triggers(number_, settings_.type, settings_.event);
  triggers_ = triggers.value_or(Triggers{});
  if (!running_ || !settings_.enabled()) {
    return;
  }
  if (triggers_.timer) {
    event_.start(std::chrono::milliseconds(settings_.event));
  }
  look_for_change();
}

canopen::Duration TransmitPdo::inhibit_time() const {
  return std::max(context_.rules.inhibit_unit * settings_.inhibit, context_.rules.inhibit_floor);
}

bool TransmitPdo::changed(const canopen::Frame& frame) const {
  return !last_ || frame.data != last_->data || frame.size != last_->size;
}

void TransmitPdo::look_for_change() {
  if (!running_ || !settings_.enabled() || !triggers_.change || inhibit_.running()) {
    return;
  }
  const auto frame = pack(context_.dictionary, settings_);
  if (frame && changed(*frame)) {
    request();
  }
}

void TransmitPdo::request() {
  if (!running_ || !settings_.enabled()) {
    return;
  }
  if (inhibit_.running()) {
    waiting_ = true;
    return;
  }
  if (const auto frame = pack(context_.dictionary, settings_)) {
    send(*frame);
    if (inhibit_time() > canopen::Duration::zero()) {
      inhibit_.start(inhibit_time());
    }
  }
  if (triggers_.timer) {
    event_.start(std::chrono::milliseconds(settings_.event));
  }
}

void TransmitPdo::end_inhibit() {
  if (waiting_) {
    waiting_ = false;
    request();
  } else {
    look_for_change();
  }
}

bool TransmitPdo::sync_started(std::optional<std::uint8_t> counter) {
  // CiA 301 §7.5.2.37 sub-index 6: with a counter, the first SYNC that counts has the start value.
  if (!sync_started_ && counter && settings_.sync_start != 0 && *counter != settings_.sync_start) {
    return false;
  }
  if (!sync_started_) {
    sync_started_ = true;
    if (counter && settings_.sync_start != 0) {
      syncs_ = static_cast<std::uint8_t>(settings_.type - 1);  // The start SYNC itself is answered.
    }
  }
  return true;
}

void TransmitPdo::on_sync(std::optional<std::uint8_t> counter) {
  if (!running_ || !settings_.enabled()) {
    return;
  }
  const auto frame = pack(context_.dictionary, settings_);
  if (!frame) {
    return;
  }
  if (triggers_.changed_at_sync && changed(*frame)) {
    send(*frame);
  }
  if (triggers_.remote && settings_.type == 252) {
    sample_ = frame;
  }
  if (triggers_.every_sync == 0 || !sync_started(counter)) {
    return;
  }
  if (++syncs_ >= triggers_.every_sync) {
    syncs_ = 0;
    send(*frame);
  }
}

void TransmitPdo::on_remote_request() {
  if (!running_ || !settings_.enabled() || !triggers_.remote) {
    return;
  }
  const auto frame = sample_ ? sample_ : pack(context_.dictionary, settings_);
  if (frame) {
    send(*frame);
  }
}

void TransmitPdo::on_rpdo() {
  if (triggers_.rpdo) {
    request();
  }
}

void TransmitPdo::send(const canopen::Frame& frame) {
  last_ = frame;
  ++context_.record.tpdos;
  context_.send(frame);
}

}  // namespace simulator
