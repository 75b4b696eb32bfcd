// The frames a drive receives and sends; its life and its errors are in drive.cpp.
#include <utility>

#include "simulator/drive.h"

namespace simulator {
namespace {

constexpr std::uint8_t kStart = 0x01;
constexpr std::uint8_t kStop = 0x02;
constexpr std::uint8_t kEnterPreOperational = 0x80;
constexpr std::uint8_t kResetNode = 0x81;
constexpr std::uint8_t kResetCommunication = 0x82;

}  // namespace

bool Drive::hears() const noexcept {
  return powered() && state_ != NmtState::initialising && !misbehaviour_.unplugged;
}

void Drive::on_frame(const canopen::Frame& frame) {
  if (!hears() || frame.extended || frame.error) {
    return;
  }
  if (frame.id == 0) {
    on_nmt(frame);
  } else if (frame.id == (sync_cob_id_ & canopen::kMaxCobId) && !frame.remote) {
    on_sync(frame);
  } else if (frame.id == 0x600U + node_ && !frame.remote) {
    on_sdo_request(frame);
  } else if (frame.id > 0x700 && frame.id < 0x780) {
    if (frame.remote && frame.id == 0x700U + node_) {
      error_control_.on_guarding_request();
    } else if (!frame.remote && frame.size == 1) {
      heartbeat_consumer_.on_heartbeat(static_cast<std::uint8_t>(frame.id - 0x700));
    }
  } else if (state_ == NmtState::operational) {
    pdos_.on_frame(frame);
  }
}

void Drive::on_nmt(const canopen::Frame& frame) {
  if (frame.remote || frame.size != 2 || (frame.data[1] != 0 && frame.data[1] != node_)) {
    return;
  }
  record_.note_nmt({frame.data[0], frame.data[1], canopen::Clock::now()});
  switch (frame.data[0]) {
    case kStart:
      enter(NmtState::operational);
      break;
    case kStop:
      enter(NmtState::stopped);
      break;
    case kEnterPreOperational:
      enter(NmtState::pre_operational);
      break;
    case kResetNode:
      restart();
      break;
    case kResetCommunication:
      stop_communication();
      if (!model_->traits().keeps_settings_on_reset_communication) {
        restore_communication_settings();
      }
      start_communication();
      break;
    default:
      break;
  }
}

void Drive::on_sync(const canopen::Frame& frame) {
  ++record_.syncs;
  // CiA 301 §7.2.5.3: with a counter one byte, without one none.
  const std::uint8_t expected = sync_overflow_ != 0 ? 1 : 0;
  if (frame.size != expected) {
    ++record_.sync_length_errors;
    if (model_->traits().sync_counter) {
      emergency_.raise(ErrorSource::sync_length, {0x8240, kCommunicationError, {}});
    }
    return;
  }
  emergency_.clear(ErrorSource::sync_length);
  if (state_ == NmtState::operational) {
    pdos_.on_sync(expected != 0 ? std::optional(frame.data[0]) : std::nullopt);
  }
}

void Drive::on_sdo_request(const canopen::Frame& frame) {
  if (state_ == NmtState::stopped) {
    return;
  }
  if (misbehaviour_.sdo_drops_left != 0) {
    --misbehaviour_.sdo_drops_left;
    return;
  }
  if (late_answers_.size() >= kLateAnswers) {
    return;  // Overrun, as on a drive whose receive buffer is full.
  }
  const auto answer = sdo_.handle(frame);
  if (answer) {
    late_answers_.push_back(
        {canopen::Clock::now() + misbehaviour_.sdo_delay, spoil_sdo_answer(frame, *answer, misbehaviour_)});
    answer_due();
  }
  if (state_ == NmtState::operational) {
    pdos_.look_for_changes();
  }
}

Abort Drive::refuse_sdo_write(Address address) const {
  if ((!misbehaviour_.local && !misbehaviour_.pdo_only) || !pdos_.receives(address)) {
    return Abort::none;
  }
  return misbehaviour_.local ? Abort::local_control : static_cast<Abort>(*misbehaviour_.pdo_only);
}

void Drive::answer_due() {
  const canopen::TimePoint now = canopen::Clock::now();
  while (!late_answers_.empty() && late_answers_.front().due <= now) {
    send(late_answers_.front().frame);
    late_answers_.pop_front();
  }
  if (!late_answers_.empty()) {
    answer_alarm_.start(late_answers_.front().due - now);
  }
}

void Drive::on_bus_up() {
  if (std::exchange(boot_up_waiting_, false)) {
    send_boot_up();
  }
}

void Drive::send_boot_up() {
  if (misbehaviour_.boot_up_missing) {
    return;
  }
  canopen::Frame frame;
  frame.id = 0x700U + node_;
  frame.size = 1;
  ++record_.boot_ups;
  // A real controller keeps the frame until somebody on the bus acknowledges it.
  boot_up_waiting_ = !send(with_length(frame, misbehaviour_.heartbeat_length));
}

void Drive::send_status(std::uint8_t status) {
  if (misbehaviour_.heartbeat_stopped) {
    return;
  }
  canopen::Frame frame;
  frame.id = 0x700U + node_;
  frame.size = 1;
  frame.data[0] = status;
  send(with_length(frame, misbehaviour_.heartbeat_length));
}

void Drive::send_emergency(std::uint32_t cob_id, const EmergencyMessage& message) {
  // CiA 301 §7.3.2.2.4: no EMCY in stopped and while initialising.
  if (state_ != NmtState::operational && state_ != NmtState::pre_operational) {
    return;
  }
  canopen::Frame frame;
  frame.id = cob_id;
  frame.size = 8;
  frame.data[0] = static_cast<std::uint8_t>(message.code);
  frame.data[1] = static_cast<std::uint8_t>(message.code >> 8U);
  frame.data[2] = message.error_register;
  for (std::size_t i = 0; i < message.vendor.size(); ++i) {
    frame.data[3 + i] = message.vendor[i];
  }
  ++record_.emergencies;
  send(with_length(frame, misbehaviour_.emcy_length));
}

bool Drive::send(const canopen::Frame& frame) {
  if (misbehaviour_.mute || misbehaviour_.unplugged) {
    return true;
  }
  return network_.send(frame);
}

}  // namespace simulator
