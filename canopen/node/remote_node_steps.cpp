// The steps that the life of a node is made of, and what belongs to a stage of it.

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/communication_objects.h"
#include "canopen/hex.h"
#include "canopen/node/motor_check.h"
#include "canopen/node/remote_node.h"

namespace canopen {
namespace {

// On hints of a second node; its answers cost the bus next to nothing.
constexpr Duration kSerialPause = std::chrono::seconds(10);
/// So that two answers may be missing where the time of one is a third of heartbeat_timeout at most.
constexpr int kLooksPerTimeout = 4;
struct AskedObject {
  ObjectAddress object;
  DataType type{};
};
// Every node has them (CiA 301 §7.5.2). In turn, for an object whose answer is missing cannot be asked for again at
// once.
constexpr std::array kSigns{AskedObject{kDeviceType, DataType::u32}, AskedObject{kErrorRegister, DataType::u8},
                            AskedObject{kProducerHeartbeat, DataType::u16}};

}  // namespace

bool RemoteNode::to_be_held(FoundState found) {
  const bool restarting = std::exchange(restarting_, false);
  if (found == FoundState::operational || !start_requests_.empty()) {
    return false;
  }
  // Somebody stopped it; nothing of it is known to have begun anew.
  return found == FoundState::stopped || (expectation_.left_by_itself() && !restarting);
}

void RemoteNode::enter(Stage stage) {
  stage_ = stage;
  const TimePoint now = Clock::now();
  switch (stage) {
    case Stage::searching:
      if (without_error_control()) {
        watch_.suspend();  // It is only listened to now, and asked at the end.
      }
      break;
    case Stage::silent:
      guarding_.stop();
      watch_.suspend();
      break;
    case Stage::configuring:  // Its heartbeat may only be switched on in the course of it.
    case Stage::starting:
      watch_.suspend();
      break;
    case Stage::inspecting:
    case Stage::waiting:
      if (heard_.by_guarding || !heard_.heartbeat_at) {
        watch_.suspend();  // Nothing comes unasked; it is asked again.
      } else if (stage == Stage::waiting || !watch_.watching()) {
        watch_.watch(now);
      }
      break;
    case Stage::held:
      if (heartbeat_is_fresh() && !watch_.watching()) {
        watch_.watch(now);
      }
      break;
    case Stage::serving:
      watch_.watch(now);
      break;
  }
}

void RemoteNode::end_life() {
  if (life_ != nullptr) {
    life_->end();
  }
  stage_ = Stage::searching;
  verified_tpdos_.clear();
  sdo_.interrupt();
  outputs_.cease();
  withdraw_nmt(NmtGroup::of_this_life);
  changed_.notify();
}

bool RemoteNode::heartbeat_is_fresh() const {
  return heard_.heartbeat_at && Clock::now() - *heard_.heartbeat_at <= settings_.error_control.heartbeat_timeout;
}

void RemoteNode::forget_stale_signs() {
  const TimePoint oldest = Clock::now() - settings_.error_control.heartbeat_timeout;
  if (!heartbeat_is_fresh() && !heard_.stopped_by_us) {
    heard_.state.reset();
    heard_.heartbeat_at.reset();
    heard_.by_guarding = false;
  }
  if (heard_.tpdo_at && *heard_.tpdo_at < oldest) {
    heard_.tpdo_at.reset();
  }
}

void RemoteNode::accept(const BootReport& report) {
  verified_tpdos_ = report.verified_tpdos;
  doubled_.set_rate_known(report.heartbeat_as_wanted);
  for (const std::string& remark : report.remarks) {
    events_.on_remark(remark);
  }
  if (report.emcy) {
    events_.on_emcy_checked(*report.emcy);
  }
  half_done_.clear();
  heard_.boot_up = false;
  self_start_due_ = false;
  change_status([](NodeStatus& status) { status.configured = true; });
}

void RemoteNode::go_online(Arrival arrival) {
  enter(Stage::serving);
  restart_.come_online(Clock::now());
  change_status([this](NodeStatus& status) {
    status.online = true;
    status.configured = true;
    status.lost = false;
    status.set_nmt(heard_.state.value_or(status.nmt));
    status.boot_result = BootResult::ok;
    status.held_back = HeldBack::no;
    status.boot_text.clear();
  });
  events_.on_arrival(arrival);
  changed_.notify();
}

/// False where the command could not leave, or the life is over.
boost::asio::awaitable<bool> RemoteNode::make_pre_operational(const LifeContext& context) {
  const TimePoint deadline = Clock::now() + kNmtTime;
  const NmtExpectation before = expectation_;
  expectation_.interrupt_for_boot(deadline);
  const NmtExpectation given = expectation_;
  const Result<void> left = co_await transmit_nmt(NmtCommand::pre_operational, deadline);
  if (context.life.over()) {
    co_return false;
  }
  if (left.has_error() && !left.error().outcome_unknown) {
    if (expectation_ == given) {
      expectation_ = before;
    }
    co_return false;
  }
  self_start_due_ = false;
  expectation_.interrupt_for_boot(Clock::now());
  heard_.state.reset();
  heard_.stopped_by_us = false;
  heard_.tpdo_at.reset();
  co_return true;
}

boost::asio::awaitable<bool> RemoteNode::started_itself(const LifeContext& context) {
  if (!settings_.self_starting || !self_start_due_ || context.life.over()) {
    co_return false;
  }
  const std::optional<bool> running = co_await motor_runs();
  co_return running == false && self_start_due_ && !context.life.over();
}

/// What the node says of its errors, where it says something.
boost::asio::awaitable<std::string> RemoteNode::error_text(const LifeContext& context) {
  const Result<Raw> reg = co_await sdo_.read(kErrorRegister, DataType::u8);
  if (context.life.over() || reg.has_error() || reg.value() == 0) {
    co_return std::string();
  }
  const Result<Raw> newest = co_await sdo_.read(kNewestError, DataType::u32);
  std::string text = "; its error register 0x1001 is 0x" + hex(reg.value(), 2);
  if (newest.has_value() && newest.value() != 0) {
    text += ", its newest error 0x1003:01 0x" + hex(newest.value(), 8);
  }
  co_return text;
}

/// What speaks against starting a node that left operational by itself; what is told of it then. Empty: nothing.
boost::asio::awaitable<std::string> RemoteNode::why_not_to_restart(const LifeContext& context) {
  std::string reason = co_await why_not_to_start(sdo_, settings_.motor);
  if (context.life.over() || !expectation_.left_by_itself()) {  // Somebody stopped it meanwhile.
    co_return std::string();
  }
  hold_reason_ = std::move(reason);
  if (hold_reason_.empty() && !restart_.foreign_nmt()) {
    co_return std::string();
  }
  restart_.put_off(Clock::now());
  change_status([this](NodeStatus& status) { note_left_by_itself(status); });
  co_return status_.boot_text;
}

/// Begins it: the motor is looked at before the first write, and again before the start.
boost::asio::awaitable<void> RemoteNode::restart_if_due(Life& life) {
  if (life.over() || Clock::now() < restart_.at()) {
    co_return;
  }
  const std::string against = co_await why_not_to_restart(context(life));
  if (life.over() || !against.empty()) {
    co_return;
  }
  restart_.end();
  if (expectation_.left_by_itself()) {
    restarting_ = true;
    note_out_of_service();
    end_life();
  }
}

TimePoint RemoteNode::next_look() const {
  if (!without_error_control() || status_.nmt_now() == NmtState::stopped) {
    return kNever;  // A stopped node answers nothing.
  }
  return status_.last_heartbeat.value_or(TimePoint{}) + settings_.error_control.heartbeat_timeout / kLooksPerTimeout;
}

/// Any answer will do, an abort too: on_sign_of_life() hears it. One that is missing has taken its time already.
boost::asio::awaitable<void> RemoteNode::read_for_sign_of_life(Life& life) {
  const Duration pace = settings_.error_control.heartbeat_timeout / kLooksPerTimeout;
  for (const AskedObject& sign : kSigns) {
    if (life.over() || Clock::now() < next_look()) {
      co_return;
    }
    const TimePoint begun = Clock::now();
    static_cast<void>(co_await sdo_.probe(sign.object, sign.type));
    if (Clock::now() >= next_look()) {  // No answer, or one that does not count: from_before().
      co_await pause(life, begun + pace);
    }
  }
}

TimePoint RemoteNode::next_serial_read() const noexcept {
  return doubled_.verdict() == Doubled::no ? kNever : serial_read_at_;
}

/// Two nodes answer with two numbers; the SDO client hears the second one. With proof, too: it lasts as long as both
/// are there.
boost::asio::awaitable<void> RemoteNode::read_serial_if_doubled(Life& life) {
  if (life.over() || Clock::now() < next_serial_read()) {
    co_return;
  }
  serial_read_at_ = Clock::now() + kSerialPause;
  static_cast<void>(co_await sdo_.probe(kSerialNumber, DataType::u32));
}

void RemoteNode::note_left_by_itself(NodeStatus& status) const {
  status.boot_result = BootResult::not_configured;
  status.held_back = HeldBack::left_operational;
  status.boot_text = "the drive left operational by itself and is " + std::string(name_of(status.nmt)) + "; ";
  if (!hold_reason_.empty()) {
    status.boot_text += "it is not started again yet: " + hold_reason_;
  } else if (restart_.at() != kNever) {
    status.boot_text += "it is about to be configured and started again";
  } else {
    status.boot_text += "it is not started again before an NMT start command or its boot-up";
  }
  if (settings_.restart && restart_.foreign_nmt()) {
    status.boot_text += ", for another master sends NMT commands";
  }
}

/// What is told of it is not from a node in service any more.
void RemoteNode::note_out_of_service() {
  change_status([](NodeStatus& status) {
    status.online = false;
    status.configured = false;
  });
}

void RemoteNode::note_not_booted(NodeStatus& status) {
  status.online = false;
  status.configured = false;
  status.boot_result = BootResult::not_booted;
  status.held_back = HeldBack::no;
  status.boot_text.clear();
}

}  // namespace canopen
