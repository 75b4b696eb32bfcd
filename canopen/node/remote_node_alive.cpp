// What tells that a node lives: boot-up, heartbeats, answers to guarding, without either its TPDOs and SDO answers; and
// its silence. As in remote_node_heard.cpp handlers never wait.

#include <algorithm>
#include <chrono>

#include "canopen/bus/bus.h"
#include "canopen/communication_objects.h"
#include "canopen/node/remote_node.h"

namespace canopen {
namespace {

constexpr std::uint8_t kToggleBit = 0x80;  // CiA 301 §7.2.8.2.2.1

}  // namespace

void RemoteNode::on_error_control(const Received& received) {
  const std::optional<HeartbeatMessage> message = decode_heartbeat(received.frame.bytes());
  if (!message) {
    return;
  }
  if (message->boot_up) {
    on_boot_up(received.at);
  } else if (guarding_.running()) {
    on_guarding_answer(message->state, (received.frame.data[0] & kToggleBit) != 0, received.at);
  } else if (heard_.guarding_asked) {
    on_single_guarding_answer(message->state, received.at);
  } else {
    on_heartbeat(message->state, received.at);
  }
  doubled_.on_error_control(*message, received.at);
}

void RemoteNode::on_boot_up(TimePoint at) {
  heard_ = Heard{.boot_up = true};
  lost_waiting_ = false;
  slow_heartbeat_ = false;
  expectation_.begin_anew();
  restart_.begin_anew();
  retry_.begin_anew();
  patience_.begin(at);
  hold_reason_.clear();
  half_done_.clear();
  self_start_due_ = true;
  watch_.suspend();
  guarding_.stop();
  guarding_.begin_anew();
  end_life();
  change_status([at](NodeStatus& status) {
    note_not_booted(status);
    status.set_nmt(NmtState::initialising);
    status.last_heartbeat = at;
    status.lost = false;
    ++status.boot_ups;
  });
  events_.on_boot_up();
}

void RemoteNode::on_heartbeat(NmtState state, TimePoint at) {
  status_.last_heartbeat = at;
  const StateMeaning meaning = expectation_.hear(state, at);
  if (meaning == StateMeaning::from_before) {
    return;
  }
  patience_.hear(state == NmtState::operational, at);
  heard_.heartbeat_at = at;
  heard_.by_guarding = false;
  heard_.longest_gap = std::max(heard_.longest_gap, at - heard_.cyclic_at.value_or(at));
  heard_.cyclic_at = at;
  watch_.alive(at);
  if (stage_ == Stage::configuring && !sdo_.answered()) {
    watch_before_answers();
  }
  if (status_.lost) {
    change_status([](NodeStatus& status) { status.lost = false; });
    if (stage_ != Stage::configuring && stage_ != Stage::starting) {
      watch_.watch(at);
    }
  }
  take_state(state, meaning);
}

void RemoteNode::on_guarding_answer(NmtState state, bool toggle, TimePoint at) {
  switch (guarding_.take(toggle)) {
    case GuardAnswer::good:
      on_heartbeat(state, at);
      break;
    case GuardAnswer::wrong_toggle:
      events_.on_remark(
          "the toggle bit of a guarding answer did not alternate, so it does not count: an answer was lost, or it is "
          "no "
          "answer to guarding");
      break;
    case GuardAnswer::wrong_toggle_again:
      break;
  }
}

void RemoteNode::on_sign_of_life(TimePoint at) {
  if (expectation_.from_before(at)) {
    return;
  }
  status_.last_heartbeat = at;
  watch_.alive(at);
  if (status_.lost && stage_ != Stage::silent) {
    change_status([](NodeStatus& status) { status.lost = false; });
  }
}

void RemoteNode::on_single_guarding_answer(NmtState state, TimePoint at) {
  heard_.guarding_asked = false;
  heard_.by_guarding = true;
  status_.last_heartbeat = at;
  patience_.hear(state == NmtState::operational, at);
  take_state(state, expectation_.hear(state, at));
}

/// Nothing was written to it yet, so its heartbeat is as it was, and may have a longer period than it will be given.
/// One that boots without a heartbeat is not watched, nor is one that answers: its heartbeat may be about to change.
void RemoteNode::watch_before_answers() {
  if (sdo_.answered() || !heard_.cyclic_at || heard_.longest_gap == Duration::zero()) {
    watch_.suspend();
    return;
  }
  const bool slow = heard_.longest_gap >= settings_.error_control.heartbeat_timeout;
  watch_.watch(*heard_.cyclic_at, slow ? heard_.longest_gap + heard_.longest_gap / 2 : Duration::zero());
}

/// Asked once after each try to boot it.
boost::asio::awaitable<bool> RemoteNode::has_slow_heartbeat() {
  if (!slow_heartbeat_) {
    const Result<Raw> period = co_await sdo_.probe(kProducerHeartbeat, DataType::u16);
    slow_heartbeat_ =
        period.has_value() && std::chrono::milliseconds(period.value()) >= settings_.error_control.heartbeat_timeout;
  }
  co_return slow_heartbeat_;
}

void RemoteNode::on_silence() {
  if (stage_ == Stage::configuring && sdo_.answered()) {
    return;  // It began to answer since the watch began: watch_before_answers().
  }
  if (without_error_control() && bus_.state().up() && status_.nmt_now() == NmtState::stopped) {
    on_silence_after_stop();
    return;
  }
  const bool was_heard = heard_.heartbeat_at.has_value() || (without_error_control() && status_.online);
  if (bus_.state().up()) {
    // It may have rebooted unseen. Where nobody can hear it, what holds it goes on.
    expectation_.begin_anew();
    restart_.end();
  }
  half_done_.clear();
  patience_.expect_boot_up();
  if (stage_ != Stage::searching) {
    // A search goes on: it asks the node at its end.
    // Guarding requests go on: the answer to the last one may be on its way. They end where the search finds nobody.
    heard_ = Heard{};
    lost_waiting_ = stage_ == Stage::waiting;
    const TimePoint retry_at = lost_waiting_ ? retry_at_ : TimePoint{};
    end_life();
    retry_at_ = retry_at;
  }
  change_status([was_heard](NodeStatus& status) {
    status.online = false;
    status.configured = false;
    status.set_nmt(NmtState::unknown);
    status.lost = true;
    if (was_heard) {
      ++status.heartbeat_losses;
    }
    // A letter stays until the drive is found silent: it may well answer, only without a heartbeat.
    if (status.boot_result == BootResult::ok) {
      status.boot_result = BootResult::not_booted;
    }
  });
}

/// It was told to be silent, and only an answer would tell that it is there: offline, and no loss. What comes next is
/// told to a stopped node.
void RemoteNode::on_silence_after_stop() {
  heard_ = Heard{.state = NmtState::stopped, .stopped_by_us = true};
  end_life();
  change_status([](NodeStatus& status) {
    status.online = false;
    status.configured = false;
  });
}

}  // namespace canopen
