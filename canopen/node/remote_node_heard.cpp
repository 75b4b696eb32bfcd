// What a node is heard to say: its state, TPDOs, emergencies; and what its bus tells. Handlers run inside the
// dispatch of a frame and never wait: they record, and end the life where it cannot go on.

#include <algorithm>
#include <array>
#include <span>

#include "canopen/bus/bus.h"
#include "canopen/cob_id.h"
#include "canopen/nmt_frame.h"
#include "canopen/node/emcy.h"
#include "canopen/node/remote_node.h"
#include "canopen/sdo/frames.h"

namespace canopen {

void RemoteNode::subscribe() {
  const std::uint32_t node = settings_.node;
  subscriptions_.push_back(
      bus_.subscribe(kErrorControlBase + node, [this](const Received& received) { on_error_control(received); }));
  subscriptions_.push_back(bus_.subscribe(kEmcyBase + node, [this](const Received& received) { on_emcy(received); }));
  subscriptions_.push_back(bus_.subscribe(kNmtCobId, [this](const Received& received) { on_foreign_nmt(received); }));
  for (std::size_t i = 0; i < tpdos_.size(); ++i) {
    subscriptions_.push_back(bus_.subscribe(settings_.tpdos[i].cob_id,
                                            [this, i](const Received& received) { on_tpdo(tpdos_[i], received); }));
  }
  doubled_.start();
  subscriptions_.push_back(bus_.subscribe_state([this](const BusState& state) { on_bus_state(state); }));
  if (without_error_control()) {
    subscriptions_.push_back(
        bus_.subscribe(kSdoAnswerBase + node, [this](const Received& received) { on_sign_of_life(received.at); }));
  }
  subscriptions_.push_back(bus_.subscribe_losses([this](std::uint32_t) {
    guarding_.forget();
    sdo_.on_frames_lost();
    watch_.frames_lost(Clock::now());
    events_.on_frames_lost();
  }));
}

void RemoteNode::take_state(NmtState state, StateMeaning meaning) {
  const bool operational = state == NmtState::operational;
  const bool left_operational = status_.nmt == NmtState::operational && !operational && state != NmtState::unknown;
  if (state != NmtState::unknown) {
    heard_.state = state;
    heard_.boot_up = heard_.boot_up && !operational;
  }
  if (meaning == StateMeaning::left && !half_done_.empty()) {
    expectation_.want_start();  // Somebody had started it while it was being configured; that goes on now.
    meaning = StateMeaning::usual;
  }
  if (stage_ == Stage::starting && operational && meaning == StateMeaning::usual) {
    go_online(Arrival::booted);
    return;
  }
  if (meaning == StateMeaning::left) {
    hold_reason_.clear();
    restart_.leave(Clock::now());
  }
  if (state != NmtState::unknown) {
    tell_state(state, meaning);
  }
  if (ends_life(state, meaning, left_operational)) {
    retry_.begin_anew();
    note_out_of_service();
    end_life();
  } else if (stage_ == Stage::serving && left_operational) {
    withdraw_commands();
  }
  changed_.notify();
}

/// What was begun with the node cannot go on.
bool RemoteNode::ends_life(NmtState state, StateMeaning meaning, bool left_operational) const {
  const bool started = meaning == StateMeaning::started || meaning == StateMeaning::started_again;
  switch (stage_) {
    case Stage::searching:
      return false;
    case Stage::silent:
      return true;
    case Stage::serving:
      // It may have rebooted unseen when it left, so its settings are looked at again.
      return meaning == StateMeaning::started_again;
    case Stage::configuring:
      return started || state == NmtState::stopped;  // Nothing more is written to it; stopped it answers nothing.
    case Stage::starting:
    case Stage::held:
      return started;
    case Stage::inspecting:
    case Stage::waiting:
      return started || left_operational;
  }
  return false;
}

void RemoteNode::tell_state(NmtState state, StateMeaning meaning) {
  change_status([&](NodeStatus& status) {
    status.nmt = state;
    if (meaning != StateMeaning::from_before) {
      status.commanded.reset();
    }
    if (meaning == StateMeaning::left) {
      status.configured = status.configured && stage_ == Stage::serving;
      note_left_by_itself(status);
    }
  });
}

void RemoteNode::on_tpdo(const Tpdo& tpdo, const Received& received) {
  if (expectation_.from_before(received.at)) {
    return;
  }
  heard_.tpdo_at = received.at;
  patience_.hear(true, received.at);  // Whoever sends them is operational.
  if (without_error_control()) {
    on_sign_of_life(received.at);
  }
  const bool nothing_else_tells = without_error_control() && !heard_.heartbeat_at;
  if (stage_ == Stage::starting || (stage_ == Stage::configuring && nothing_else_tells)) {
    // Whoever sends TPDOs is operational (CiA 301 table 37).
    take_state(NmtState::operational, expectation_.hear(NmtState::operational, received.at));
  } else if (stage_ == Stage::silent) {
    end_life();
  } else if (stage_ == Stage::searching) {
    changed_.notify();
  }
  if (stage_ != Stage::serving) {
    if (!heard_.heartbeat_at) {
      watch_.alive(received.at);  // All there is of a node without heartbeat that waits for another try.
    }
    return;
  }
  if (received.frame.size != tpdo.plan.byte_count()) {
    events_.on_tpdo_length(tpdo.number, tpdo.plan.byte_count(), received.frame.size);
  }
  std::array<Raw, kMaxPdoFields> values{};
  if (tpdo.plan.decode(received.frame.bytes(), values)) {
    events_.on_tpdo(tpdo.number, std::span<const Raw>(values).first(tpdo.plan.field_count()), received.at,
                    received.wall);
  }
}

void RemoteNode::on_emcy(const Received& received) {
  if (const std::optional<Emcy> emcy = decode_emcy(settings_.emcy, received.frame.bytes())) {
    change_status([](NodeStatus& status) { ++status.emergencies; });
    events_.on_emcy(*emcy, received.at, received.wall);
    if (stage_ == Stage::waiting && status_.held_back == HeldBack::start_ignored && emcy->reset &&
        emcy->error_register == 0) {
      retry_.begin_anew();  // What kept it from starting has gone.
      retry_at_ = std::min(retry_at_, Clock::now() + RetryPause::kFirst);
      changed_.notify();
    }
  }
}

// Our own commands come back as echoes, which are never dispatched.
void RemoteNode::on_foreign_nmt(const Received& received) {
  if (nmt_specifier_for(received.frame, settings_.node)) {
    restart_.hear_foreign_nmt();
    self_start_due_ = false;  // Who started it is not known.
    if (expectation_.left_by_itself()) {
      change_status([this](NodeStatus& status) { note_left_by_itself(status); });
    }
  }
}

void RemoteNode::on_doubled() {
  if (doubled_.verdict() == Doubled::proof) {
    withdraw_commands();
  }
  change_status([this](NodeStatus& status) {
    status.doubled = doubled_.verdict();
    status.doubled_text = doubled_.text();
  });
  changed_.notify();
}

void RemoteNode::on_bus_state(const BusState& state) {
  if (!state.up()) {
    guarding_.stop();
    guarding_.forget();
    heard_ = Heard{};
    half_done_.clear();
    expectation_.begin_boot();  // It may reboot unseen.
    retry_.begin_anew();
    patience_.expect_boot_up();
    end_life();
    change_status([](NodeStatus& status) {
      note_not_booted(status);
      status.set_nmt(NmtState::unknown);
    });
  }
  changed_.notify();
}

}  // namespace canopen
