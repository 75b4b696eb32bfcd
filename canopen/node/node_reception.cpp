// What a supervisor hears: error control, TPDOs, emergencies, the bus. Handlers run inside the dispatch of a frame and
// never wait.

#include <array>
#include <span>

#include "canopen/bus/bus.h"
#include "canopen/node/emcy.h"
#include "canopen/node/node_supervisor.h"

namespace canopen {
namespace {

constexpr std::uint32_t kEmcyBase = 0x080;
constexpr std::uint32_t kErrorControlBase = 0x700;

}  // namespace

void RemoteNode::Supervisor::subscribe() {
  const std::uint32_t node = settings_.node;
  subscriptions_.push_back(
      bus_.subscribe(kErrorControlBase + node, [this](const Received& received) { on_error_control(received); }));
  subscriptions_.push_back(bus_.subscribe(kEmcyBase + node, [this](const Received& received) { on_emcy(received); }));
  for (std::size_t i = 0; i < tpdos_.size(); ++i) {
    subscriptions_.push_back(bus_.subscribe(settings_.tpdos[i].cob_id,
                                            [this, i](const Received& received) { on_tpdo(tpdos_[i], received); }));
  }
  subscriptions_.push_back(bus_.subscribe_state([this](const BusState& state) { on_bus_state(state); }));
  subscriptions_.push_back(bus_.subscribe_losses([this](std::uint32_t) {
    watch_.frames_lost(Clock::now());
    events_.on_frames_lost();
  }));
}

void RemoteNode::Supervisor::on_error_control(const Received& received) {
  const std::optional<HeartbeatMessage> message = decode_heartbeat(received.frame.bytes());
  if (!message || received.frame.remote) {
    return;
  }
  if (message->boot_up) {
    on_boot_up(received.at);
  } else if (signs_.guarding_asked) {
    on_guarding_answer(message->state, received.at);
  } else {
    on_state(message->state, received.at);
  }
}

void RemoteNode::Supervisor::on_boot_up(TimePoint at) {
  signs_ = NodeSigns{};
  signs_.boot_up = true;
  hold_ = Hold::none;
  watch_.suspend();
  leave_service();
  change_status([at](NodeStatus& status) {
    status.online = false;
    status.configured = false;
    status.nmt = NmtState::initialising;
    status.boot_result = kNotBooted;
    status.boot_text.clear();
    status.last_heartbeat = at;
    status.lost = false;
    ++status.boot_ups;
  });
  events_.on_boot_up();
}

void RemoteNode::Supervisor::on_state(NmtState state, TimePoint at) {
  signs_.heartbeat_at = at;
  status_.last_heartbeat = at;
  signs_.by_guarding = false;
  watch_.alive(at);
  if (state != NmtState::unknown) {
    signs_.state = state;
  }
  if (status_.lost) {
    change_status([](NodeStatus& status) { status.lost = false; });
    if (phase_ != Phase::booting && phase_ != Phase::starting) {
      watch_.watch(at);
    }
  }
  if (phase_ == Phase::online) {
    on_state_online(state, at);
    return;
  }
  if (phase_ == Phase::starting && state == NmtState::operational) {
    arrive(Arrival::booted);
    return;
  }
  take_state(state, at);
}

void RemoteNode::Supervisor::on_guarding_answer(NmtState state, TimePoint at) {
  signs_.guarding_asked = false;
  signs_.by_guarding = true;
  status_.last_heartbeat = at;
  if (state != NmtState::unknown) {
    signs_.state = state;
  }
  take_state(state, at);
}

void RemoteNode::Supervisor::take_state(NmtState state, TimePoint at) {
  if (state != NmtState::unknown && state != status_.nmt) {
    const bool by_itself = status_.nmt == NmtState::operational && hold_ == Hold::none && at >= nmt_grace_end_;
    if (by_itself) {
      hold_ = Hold::by_itself;
    }
    if (by_itself && phase_ == Phase::booting) {
      leave_service();  // Somebody had started it meanwhile; nothing more is written.
    }
    change_status([state, by_itself](NodeStatus& status) {
      status.nmt = state;
      if (by_itself) {
        status.configured = false;
        note_left_by_itself(status);
      }
    });
  }
  changed_.notify();
}

void RemoteNode::Supervisor::on_state_online(NmtState state, TimePoint at) {
  if (state == NmtState::unknown) {
    return;
  }
  if (state == NmtState::operational) {
    if (hold_ == Hold::by_itself) {
      // Somebody else started it. It may have rebooted unseen when it left, so its settings are looked at again.
      leave_service();
      change_status([](NodeStatus& status) {
        status.online = false;
        status.configured = false;
        status.nmt = NmtState::operational;
      });
      return;
    }
    if (status_.nmt != NmtState::operational || at >= nmt_grace_end_) {
      hold_ = Hold::none;  // Started, by whomever, or it does not obey. Else a stop of ours may still be on its way.
    }
  } else {
    if (status_.nmt == NmtState::operational) {
      withdraw_commands();
    }
    if (hold_ == Hold::none && at >= nmt_grace_end_) {
      hold_ = Hold::by_itself;
    }
  }
  if (state == status_.nmt && (hold_ != Hold::by_itself || status_.boot_result != kBootOk)) {
    return;
  }
  change_status([this, state](NodeStatus& status) {
    status.nmt = state;
    if (hold_ == Hold::by_itself) {
      note_left_by_itself(status);
    }
  });
}

void RemoteNode::Supervisor::on_tpdo(const Tpdo& tpdo, const Received& received) {
  if (received.frame.remote) {
    return;
  }
  if (phase_ == Phase::starting) {
    signs_.state = NmtState::operational;  // Whoever sends TPDOs is operational (CiA 301 table 37).
    arrive(Arrival::booted);
  } else if (phase_ != Phase::online && !signs_.state) {
    signs_.state = NmtState::operational;
    change_status([](NodeStatus& status) { status.nmt = NmtState::operational; });
    changed_.notify();
  }
  if (phase_ != Phase::online) {
    if (!signs_.heartbeat_at) {
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

void RemoteNode::Supervisor::on_emcy(const Received& received) {
  const std::optional<Emcy> emcy = decode_emcy(settings_.emcy, received.frame.bytes());
  if (!emcy || received.frame.remote) {
    return;
  }
  change_status([](NodeStatus& status) { ++status.emergencies; });
  events_.on_emcy(*emcy, received.at, received.wall);
}

void RemoteNode::Supervisor::on_silence() {
  const bool was_heard = signs_.heartbeat_at.has_value();
  if (!searching_) {
    // A search goes on: it asks the node at its end.
    signs_ = NodeSigns{};
    leave_service();
  }
  change_status([was_heard](NodeStatus& status) {
    status.online = false;
    status.configured = false;
    status.nmt = NmtState::unknown;
    status.lost = true;
    if (was_heard) {
      ++status.heartbeat_losses;
    }
    // A letter stays until the drive is found silent: it may well answer, only without a heartbeat.
    if (status.boot_result == kBootOk) {
      status.boot_result = kNotBooted;
    }
  });
}

void RemoteNode::Supervisor::on_bus_state(const BusState& state) {
  if (!state.up()) {
    signs_ = NodeSigns{};
    leave_service();
    change_status([](NodeStatus& status) {
      status.online = false;
      status.configured = false;
      status.nmt = NmtState::unknown;
      status.boot_result = kNotBooted;
      status.boot_text.clear();
    });
  }
  changed_.notify();
}

}  // namespace canopen
