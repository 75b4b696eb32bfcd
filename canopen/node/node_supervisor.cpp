#include "canopen/node/node_supervisor.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <exception>
#include <utility>

#include "canopen/bus/bus.h"

namespace canopen {
namespace {

// How often a silent node is asked by SDO whether it is there: one frame, so that a node is found that neither boots
// visibly nor has a heartbeat.
constexpr Duration kProbeInterval = std::chrono::seconds(3);
// Keeps a life that fails at once, as with a full transmit queue, from spinning.
constexpr Duration kBreath = std::chrono::milliseconds(10);
constexpr ObjectAddress kDeviceType{0x1000, 0};

}  // namespace

RemoteNode::Supervisor::Supervisor(boost::asio::any_io_executor executor, Bus& bus, NodeSettings settings,
                                   NodeEvents& events)
    : executor_(std::move(executor)),
      bus_(bus),
      settings_(std::move(settings)),
      events_(events),
      changed_(executor_),
      ended_(executor_),
      sdo_(executor_, bus, settings_.node, settings_.sdo),
      rpdos_(executor_, bus, settings_.node, settings_.rpdos),
      watch_(
          executor_, expects_heartbeat(settings_) ? settings_.error_control.heartbeat_timeout : Duration::zero(),
          [this] { on_silence(); }, [this](TimePoint until) { return bus_.may_still_hear(until); }) {
  sdo_.on_abort(
      [this](std::uint32_t code) { change_status([code](NodeStatus& status) { status.last_abort = code; }); });
  sdo_.on_remark([this](std::string_view text) { events_.on_remark(std::string(text)); });
  tpdos_.reserve(settings_.tpdos.size());
  for (const PdoSettings& tpdo : settings_.tpdos) {
    tpdos_.push_back({tpdo.number, PdoPlan(tpdo.mapping)});
  }
}

void RemoteNode::Supervisor::start() {
  subscribe();
  running_ = true;
  boost::asio::co_spawn(executor_, run(), [this](std::exception_ptr failure) {
    running_ = false;
    ended_.notify();
    if (failure) {
      std::rethrow_exception(failure);
    }
  });
}

void RemoteNode::Supervisor::close() {
  closing_ = true;
  if (phase_ != Phase::online) {
    leave_service();
  }
}

boost::asio::awaitable<void> RemoteNode::Supervisor::stop() {
  stopping_ = true;
  subscriptions_.clear();
  watch_.suspend();
  leave_service();
  withdraw_nmt(true);
  status_.online = false;
  while (running_ || operations_ > 0) {
    co_await ended_.wait_until(TimePoint::max());
  }
  co_await sdo_.until_idle();
  co_await rpdos_.until_idle();
}

TimePoint RemoteNode::Supervisor::heard_until() const {
  return bus_.heard_until();
}

bool RemoteNode::Supervisor::tpdo_verified(std::uint16_t number) const noexcept {
  return std::find(verified_tpdos_.begin(), verified_tpdos_.end(), number) != verified_tpdos_.end();
}

boost::asio::awaitable<void> RemoteNode::Supervisor::run() {
  while (!stopping_ && !closing_) {
    const TimePoint begun = Clock::now();
    co_await live_once();
    if (!stopping_ && !closing_ && Clock::now() < begun + kBreath) {
      co_await changed_.wait_until(begun + kBreath);
    }
  }
}

/// From not knowing the node's state to its loss, reboot, or the next try.
boost::asio::awaitable<void> RemoteNode::Supervisor::live_once() {
  if (!bus_.state().up()) {
    co_await wait_for_bus();
    co_return;
  }
  phase_ = Phase::idle;
  forget_stale_signs();
  searching_ = true;
  const FoundState found = co_await learn_state({sdo_, bus_, settings_, signs_, changed_});
  searching_ = false;
  if (closing_) {
    co_return;
  }
  start_requested_ = false;
  gave_up_ = false;
  if (stopping_ || !bus_.state().up()) {
    co_return;
  }
  const std::uint64_t interruptions = sdo_.interruptions();
  switch (found) {
    case FoundState::interrupted:
      break;
    case FoundState::silent:
      co_await stay_silent();
      break;
    case FoundState::operational:
      co_await take_over();
      break;
    case FoundState::stopped:
    case FoundState::not_operational:
      co_await bring_up(found);
      break;
  }
  if (gave_up_ && sdo_.interruptions() == interruptions) {
    // Nothing came in between, our own frames could not leave: trying again at once would only add to them.
    phase_ = Phase::idle;
    co_await pause(Clock::now() + kRetryInterval, &Supervisor::boot_wanted);
  }
}

boost::asio::awaitable<void> RemoteNode::Supervisor::wait_for_bus() {
  if (!watch_.watching() && !status_.lost) {
    watch_.watch(Clock::now());  // A node that nobody can hear is missing, whatever the reason.
  }
  while (!bus_.state().up() && !stopping_) {
    co_await changed_.wait_until(TimePoint::max());
  }
}

boost::asio::awaitable<void> RemoteNode::Supervisor::stay_silent() {
  watch_.suspend();
  change_status([](NodeStatus& status) {
    status.lost = true;
    status.nmt = NmtState::unknown;
    status.boot_result = kNotBooted;
    status.boot_text.clear();
  });
  co_await pause(Clock::now() + kProbeInterval, &Supervisor::heard_sign);
}

boost::asio::awaitable<void> RemoteNode::Supervisor::serve() {
  while (phase_ == Phase::online && !stopping_) {
    co_await changed_.wait_until(TimePoint::max());
  }
}

boost::asio::awaitable<void> RemoteNode::Supervisor::fail(BootReport report) {
  phase_ = Phase::idle;
  if (signs_.by_guarding) {
    watch_.suspend();  // Nothing comes unasked; it is asked again.
  } else {
    watch_.watch(Clock::now());
  }
  change_status([&report](NodeStatus& status) {
    status.configured = false;
    status.boot_result = report.letter;
    status.boot_text = report.text;
  });
  if (report.letter == 'L') {
    // Left alone until it leaves operational, reboots or is lost: reading it again would not change it.
    const TimePoint until = signs_.by_guarding ? Clock::now() + kRetryInterval : TimePoint::max();
    co_await pause(until, &Supervisor::not_operational);
  } else {
    co_await pause(Clock::now() + kRetryInterval, &Supervisor::boot_wanted);
  }
}

boost::asio::awaitable<void> RemoteNode::Supervisor::hold_back(FoundState found) {
  if (heartbeat_is_fresh() && !watch_.watching()) {
    watch_.watch(Clock::now());
  }
  change_status([](NodeStatus& status) {
    status.configured = false;
    note_left_by_itself(status);
  });
  if (found != FoundState::stopped && !sdo_.answered()) {
    static_cast<void>(co_await sdo_.probe(kDeviceType, DataType::u32));  // Reads are let through where it answers.
  }
  co_await pause(Clock::now() + kRetryInterval, &Supervisor::hold_over);
}

boost::asio::awaitable<void> RemoteNode::Supervisor::pause(TimePoint until, bool (Supervisor::*over)() const) {
  const std::uint64_t interruptions = sdo_.interruptions();
  while (Clock::now() < until && !stopping_ && !(this->*over)() && sdo_.interruptions() == interruptions) {
    co_await changed_.wait_until(until);
  }
}

void RemoteNode::Supervisor::forget_stale_signs() {
  if (!heartbeat_is_fresh()) {
    signs_.state.reset();
    signs_.heartbeat_at.reset();
    signs_.by_guarding = false;
  }
}

bool RemoteNode::Supervisor::heartbeat_is_fresh() const {
  return signs_.heartbeat_at && Clock::now() - *signs_.heartbeat_at <= settings_.error_control.heartbeat_timeout;
}

void RemoteNode::Supervisor::leave_service() {
  phase_ = Phase::idle;
  verified_tpdos_.clear();
  sdo_.interrupt();
  rpdos_.cease();
  withdraw_nmt(false);
  changed_.notify();
}

void RemoteNode::Supervisor::withdraw_commands() {
  rpdos_.cease();
  sdo_.withdraw_commands();
}

}  // namespace canopen
