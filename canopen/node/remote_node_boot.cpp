// How a node that was found comes into service: taken over as it runs, or configured and started.

#include <optional>
#include <string>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/node/configure.h"
#include "canopen/node/error_report.h"
#include "canopen/node/remote_node.h"

namespace canopen {
namespace {

std::string why_no_error_control(const LifeContext& context, ErrorControlKind kind) {
  if (kind == ErrorControlKind::guarding) {
    return no_guarding_text(context);
  }
  return context.heard.by_guarding
             ? "it sends no heartbeat, 0x1017:00 is 0; guarding is not supported in its place, unless guarding is set"
             : "TPDOs and SDO answers come, but no heartbeat, although 0x1017:00 is set";
}

}  // namespace

/// What runs is compared, and left as it is where it differs.
boost::asio::awaitable<BootReport> RemoteNode::take_over(LifeContext context) {
  enter(Stage::inspecting);
  BootReport report = co_await inspect(context);
  const bool proven = heard_.heartbeat_at && (!guarding_.running() || guarding_.alternates());
  if (report.ok() && report.error_control != ErrorControlKind::none && !proven) {
    const bool alive = co_await heartbeat_after(context, Clock::now());
    if (!alive) {
      report.letter = BootResult::no_error_control;
      report.text = why_no_error_control(context, report.error_control);
    }
  }
  if (context.life.over()) {
    co_return report;
  }
  if (report.letter == BootResult::left_alone) {
    const bool again = settings_.reconfigure_running || co_await started_itself(context);
    if (again && !context.life.over()) {
      co_return co_await boot(context, FoundState::operational);
    }
    report.text += half_done_.empty() ? "" : "; our configuration of it was interrupted: " + half_done_;
  } else if (report.ok()) {
    accept(report);
    go_online(Arrival::taken_over);
  }
  co_return report;
}

/// Configures it and starts it, where nothing speaks against a start. What it is told to be meanwhile ends the life.
boost::asio::awaitable<BootReport> RemoteNode::boot(LifeContext context, FoundState found) {
  enter(Stage::configuring);
  expectation_.begin_boot();
  take_start_requests();
  slow_heartbeat_ = false;
  BootReport report;
  // A stopped node answers no SDO; an operational one refuses most settings.
  if (found == FoundState::stopped || found == FoundState::operational) {
    report.interrupted = !co_await make_pre_operational(context);
  }
  if (!report.interrupted) {
    report = co_await configure(context, found);
  }
  if (report.letter == BootResult::not_configured && co_await started_itself(context)) {
    report.interrupted = !co_await make_pre_operational(context);
    if (!report.interrupted) {
      report = co_await configure(context, FoundState::not_operational);
    }
  }
  if (!report.ok() || context.life.over()) {
    co_return report;
  }
  accept(report);
  take_start_requests();
  co_return co_await start_node(context);
}

boost::asio::awaitable<BootReport> RemoteNode::start_node(LifeContext context) {
  BootReport report;
  const NmtExpectation before = expectation_;
  if (before.left_by_itself()) {
    report.text = co_await why_not_to_restart(context);
    report.letter = report.text.empty() ? BootResult::ok : BootResult::not_configured;
    report.held_back = report.text.empty() ? HeldBack::no : HeldBack::left_operational;
    if (context.life.over() || !report.ok()) {
      co_return report;
    }
  }
  if (expectation_.held_by_command()) {
    if (without_error_control()) {
      heard_.state = NmtState::pre_operational;  // It answers, and was not started.
    }
    go_online(Arrival::booted);  // Configured, and held back from starting.
    co_return report;
  }
  enter(Stage::starting);
  const Result<void> left = co_await transmit_nmt(NmtCommand::start, Clock::now() + kNmtTime);
  if (context.life.over()) {
    co_return report;
  }
  if (left.has_value()) {
    settle_start_requests({});
    if (without_error_control()) {
      heard_.state = NmtState::operational;  // Nothing will ever tell; it has been commanded.
      go_online(Arrival::booted);
    }
    const TimePoint until = expectation_.settled_at();
    while (stage_ == Stage::starting && !context.life.over() && bus_.may_still_hear(until)) {
      co_await context.life.wait_until(or_soon(until));
    }
  }
  if (stage_ != Stage::starting || context.life.over()) {
    co_return report;
  }
  if (expectation_.held_by_command()) {
    go_online(Arrival::booted);  // A stop has come before it, or behind it.
  } else if (left.has_error()) {
    report.interrupted = true;
  } else {
    expectation_.begin_boot();
    if (before.left_by_itself()) {
      expectation_ = before;  // The next try, too, looks at the motor first.
    }
    events_.on_start_ignored();
    report.letter = BootResult::not_configured;
    report.held_back = HeldBack::start_ignored;
    report.text = "NMT start was sent, but the drive stays " + std::string(name_of(status_.nmt)) + "; ";
    report.text += co_await read_error_report(sdo_, context.life);
  }
  co_return report;
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
  retry_.begin_anew();
  patience_.settle();
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

}  // namespace canopen
