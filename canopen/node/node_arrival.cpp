// How a node comes online: taken over as it runs, or booted and started.

#include <string>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/node/node_supervisor.h"

namespace canopen {
namespace {

// NMT start and pre-operational of a boot that have not left by then are given up; the boot is tried again.
constexpr Duration kNmtTime = std::chrono::seconds(1);

}  // namespace

boost::asio::awaitable<void> RemoteNode::Supervisor::take_over() {
  phase_ = Phase::inspecting;
  if (hold_ == Hold::by_itself || Clock::now() >= nmt_grace_end_) {
    hold_ = Hold::none;  // Somebody has started it. Else a stop of ours has only just left, and its heartbeat is old.
  }
  if (signs_.by_guarding) {
    watch_.suspend();  // Nothing comes unasked.
  } else if (!watch_.watching()) {
    watch_.watch(Clock::now());
  }
  BootReport report = co_await inspect_running(sdo_, settings_);
  gave_up_ = report.interrupted;
  if (phase_ != Phase::inspecting || report.interrupted) {
    co_return;
  }
  if (report.ok()) {
    const bool guarding = signs_.by_guarding;
    const bool alive = co_await heartbeat_as_needed();
    if (phase_ != Phase::inspecting) {
      co_return;
    }
    if (!alive) {
      report.letter = 'E';
      report.text = guarding ? "it sends no heartbeat, 0x1017:00 is 0; guarding is not supported in its place"
                             : "TPDOs and SDO answers come, but no heartbeat, although 0x1017:00 is set";
    }
  }
  if (hold_ == Hold::by_itself) {
    co_return;  // It left operational meanwhile.
  }
  if (!report.ok()) {
    if (report.letter == 'L' && settings_.reconfigure_running) {
      co_await bring_up(FoundState::operational);
    } else {
      co_await fail(std::move(report));
    }
    co_return;
  }
  if (signs_.state != NmtState::operational) {
    co_return;
  }
  settings_done(report);
  arrive(Arrival::taken_over);
  co_await serve();
}

boost::asio::awaitable<bool> RemoteNode::Supervisor::heartbeat_as_needed() {
  // A node that was given up for its missing heartbeat is not brought back by TPDOs alone, and the answer to a guarding
  // request says nothing of the time after it.
  if (!expects_heartbeat(settings_) || signs_.heartbeat_at || !(status_.lost || signs_.by_guarding)) {
    co_return true;
  }
  co_return co_await heartbeat_after(Clock::now());
}

boost::asio::awaitable<void> RemoteNode::Supervisor::bring_up(FoundState found) {
  if (hold_ == Hold::by_itself) {
    co_await hold_back(found);
    co_return;
  }
  const bool answers_sdo = found != FoundState::stopped;
  if (!answers_sdo && !may_start()) {
    co_await pause(Clock::now() + kRetryInterval, &Supervisor::boot_wanted);
    co_return;
  }
  phase_ = Phase::booting;
  signs_.boot_up = false;
  watch_.suspend();  // Its heartbeat may only be switched on in the course of the boot.
  if (!answers_sdo || found == FoundState::operational) {
    // A stopped node answers no SDO; an operational one refuses most settings, and is here only by reconfigure_running.
    nmt_grace_end_ = Clock::now() + kNmtTime + settings_.error_control.heartbeat_timeout;
    const Result<void> left = co_await transmit_nmt(NmtCommand::pre_operational, Clock::now() + kNmtTime, true);
    gave_up_ = left.has_error();
    if (phase_ != Phase::booting || gave_up_) {
      co_return;
    }
  }
  BootReport report = co_await boot(sdo_, settings_, *this);
  gave_up_ = report.interrupted;
  const bool turned = phase_ != Phase::booting && phase_ != Phase::online;
  if (turned || report.interrupted) {
    co_return;
  }
  if (!report.ok()) {
    co_await fail(std::move(report));
    co_return;
  }
  if (phase_ == Phase::booting) {
    arrive(Arrival::booted);  // Configured, and held back from starting.
  }
  co_await serve();
}

boost::asio::awaitable<bool> RemoteNode::Supervisor::heartbeat_after(TimePoint since) {
  const TimePoint until = Clock::now() + settings_.error_control.heartbeat_timeout;
  const std::uint64_t interruptions = sdo_.interruptions();
  while (bus_.may_still_hear(until) && sdo_.interruptions() == interruptions) {
    if (signs_.heartbeat_at && *signs_.heartbeat_at >= since) {
      co_return true;
    }
    co_await changed_.wait_until(or_soon(until));
  }
  co_return false;
}

void RemoteNode::Supervisor::settings_done(const BootReport& report) {
  verified_tpdos_ = report.verified_tpdos;
  for (const std::string& remark : report.remarks) {
    events_.on_remark(remark);
  }
  change_status([](NodeStatus& status) { status.configured = true; });
}

boost::asio::awaitable<std::optional<BootFailure>> RemoteNode::Supervisor::start_node() {
  phase_ = Phase::starting;
  nmt_grace_end_ = Clock::now() + kNmtTime + settings_.error_control.heartbeat_timeout;
  const BootFailure interrupted{'J', {}, true};
  const Result<void> left = co_await transmit_nmt(NmtCommand::start, Clock::now() + kNmtTime, true);
  if (left.has_value()) {
    ++starts_;
    nmt_grace_end_ = Clock::now() + settings_.error_control.heartbeat_timeout;
    changed_.notify();
  }
  if (phase_ == Phase::starting && left.has_value() && !expects_heartbeat(settings_)) {
    signs_.state = NmtState::operational;  // Nothing will ever tell; it has been commanded.
    arrive(Arrival::booted);
  }
  while (phase_ == Phase::starting && left.has_value() && bus_.may_still_hear(nmt_grace_end_)) {
    co_await changed_.wait_until(or_soon(nmt_grace_end_));
  }
  if (phase_ == Phase::online) {
    co_return std::nullopt;
  }
  if (phase_ != Phase::starting || left.has_error()) {
    phase_ = Phase::idle;
    co_return interrupted;
  }
  phase_ = Phase::booting;
  co_return BootFailure{'J', "NMT start was sent, but the drive stays " + std::string(name_of(status_.nmt)), false};
}

void RemoteNode::Supervisor::arrive(Arrival arrival) {
  phase_ = Phase::online;
  watch_.watch(Clock::now());
  change_status([this](NodeStatus& status) {
    status.online = true;
    status.configured = true;
    status.lost = false;
    status.nmt = signs_.state.value_or(status.nmt);
    status.boot_result = kBootOk;
    status.boot_text.clear();
  });
  events_.on_arrival(arrival);
  changed_.notify();
}

void RemoteNode::Supervisor::note_left_by_itself(NodeStatus& status) {
  status.boot_result = 'J';
  status.boot_text = "the drive left operational by itself and is " + std::string(name_of(status.nmt)) +
                     "; it is not started again before an NMT start command or its boot-up";
}

}  // namespace canopen
