// The steps that the life of a node is made of, and what belongs to a stage of it.

#include <array>
#include <string>
#include <utility>

#include "canopen/communication_objects.h"
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
      watch_before_answers();
      break;
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
  retry_at_ = {};
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
