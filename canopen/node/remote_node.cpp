// The life of a node: found, inspected or configured, started, served, and again.

#include "canopen/node/remote_node.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <exception>
#include <functional>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/communication_objects.h"

namespace canopen {
namespace {

// How often a silent node is asked by SDO whether it is there: one frame, so that a node is found that neither boots
// visibly nor has a heartbeat.
constexpr Duration kProbeInterval = std::chrono::seconds(3);
// Before a node that could not be configured or taken over is tried again.
constexpr Duration kRetryInterval = std::chrono::seconds(5);
// Before one that was left alone is looked at again: only somebody else can put it right.
constexpr Duration kLookInterval = std::chrono::minutes(1);
// Keeps a life that fails at once, as with a full transmit queue, from spinning.
constexpr Duration kBreath = std::chrono::milliseconds(10);

std::string why_no_error_control(const LifeContext& context, ErrorControlKind kind) {
  if (kind == ErrorControlKind::guarding) {
    return no_guarding_text(context);
  }
  return context.heard.by_guarding
             ? "it sends no heartbeat, 0x1017:00 is 0; guarding is not supported in its place, unless guarding is set"
             : "TPDOs and SDO answers come, but no heartbeat, although 0x1017:00 is set";
}

}  // namespace

RemoteNode::RemoteNode(boost::asio::any_io_executor executor, Bus& bus, NodeSettings settings, NodeEvents& events)
    : executor_(std::move(executor)),
      bus_(bus),
      settings_(std::move(settings)),
      events_(events),
      changed_(executor_),
      ended_(executor_),
      sdo_(executor_, bus, settings_.node, settings_.sdo),
      outputs_(executor_, bus, settings_.node, settings_.rpdos,
               [this](std::uint16_t rpdo) { return events_.repetition(rpdo); }),
      watch_(
          executor_, settings_.error_control.heartbeat_timeout, [this] { on_silence(); },
          [this](TimePoint until) { return bus_.may_still_hear(until); }),
      guarding_(executor_, bus, settings_.node, settings_.error_control.guarding),
      doubled_(
          executor_, bus, settings_,
          [this](std::uint16_t tpdo) { return stage_ == Stage::serving && tpdo_verified(tpdo); },
          [this] { on_doubled(); }),
      expectation_(settings_.error_control.heartbeat_timeout),
      restart_(settings_.restart) {
  sdo_.on_second_answer([this](bool different) { doubled_.on_second_answer(different); });
  sdo_.on_abort([this](std::uint32_t code) {
    aborts_.add(code);
    change_status([code](NodeStatus& status) { status.last_abort = code; });
  });
  sdo_.on_remark([this](std::string_view text) { events_.on_remark(std::string(text)); });
  tpdos_.reserve(settings_.tpdos.size());
  for (const PdoSettings& tpdo : settings_.tpdos) {
    tpdos_.push_back({tpdo.number, PdoPlan(tpdo.mapping)});
  }
}

void RemoteNode::start() {
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

void RemoteNode::close() {
  closing_ = true;
  if (stage_ != Stage::serving) {
    end_life();
  }
}

boost::asio::awaitable<void> RemoteNode::stop() {
  closing_ = true;
  stopping_ = true;
  subscriptions_.clear();
  watch_.suspend();
  doubled_.stop();
  guarding_.stop();
  end_life();
  sdo_.close();
  withdraw_nmt(NmtGroup::all);
  status_.online = false;
  settle_start_requests(offline_error({}, "removed while it was booted"));
  while (running_ || operations_ > 0) {
    co_await ended_.wait_until(TimePoint::max());
  }
  co_await sdo_.until_idle();
  co_await outputs_.until_idle();
}

boost::asio::awaitable<void> RemoteNode::run() {
  while (!closing_) {
    const TimePoint begun = Clock::now();
    Life life(changed_);
    life_ = &life;
    co_await live(life);
    life_ = nullptr;
    while (!closing_ && Clock::now() < begun + kBreath) {
      co_await changed_.wait_until(begun + kBreath);
    }
  }
}

boost::asio::awaitable<void> RemoteNode::live(Life& life) {
  co_await bus_up(life);
  const FoundState found = co_await find(life);
  if (life.over()) {
    co_return;
  }
  if (found == FoundState::silent) {
    co_await stay_silent(life);
    co_return;
  }
  if (to_be_held(found)) {
    co_await hold_back(life, found);
    co_return;
  }
  BootReport report;
  if (found == FoundState::operational) {
    report = co_await take_over(context(life));
  } else if (found != FoundState::not_asked) {
    report = co_await boot(context(life), found);
  }
  if (life.over()) {
    co_return;
  }
  if (stage_ == Stage::serving) {
    settle_start_requests({});
    co_await serve(life);
  } else {
    co_await wait_for_retry(life, std::move(report));
  }
}

boost::asio::awaitable<void> RemoteNode::bus_up(Life& life) {
  enter(Stage::searching);
  doubled_.set_rate_known(false);
  if (!bus_.state().up() && !watch_.watching() && !status_.lost) {
    watch_.watch(Clock::now());  // A node that nobody can hear is missing, whatever the reason.
  }
  while (!bus_.state().up() && !life.over()) {
    co_await life.wait_until(TimePoint::max());
  }
}

boost::asio::awaitable<FoundState> RemoteNode::find(Life& life) {
  forget_stale_signs();
  const std::function<void(std::string)> tell = [this](std::string text) {
    change_status([&text](NodeStatus& status) { status.boot_text = std::move(text); });
  };
  const FoundState found = co_await find_state(context(life), tell);
  if (!life.over() && found == FoundState::operational && heard_.state != NmtState::operational) {
    heard_.state = NmtState::operational;  // By its TPDOs: nothing else tells.
    static_cast<void>(expectation_.hear(NmtState::operational, Clock::now()));
    change_status([](NodeStatus& status) { status.set_nmt(NmtState::operational); });
  }
  co_return found;
}

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
    report.text = "NMT start was sent, but the drive stays " + std::string(name_of(status_.nmt));
    report.text += co_await error_text(context);
  }
  co_return report;
}

boost::asio::awaitable<void> RemoteNode::serve(Life& life) {
  while (!life.over()) {
    const TimePoint next = std::min({restart_.at(), next_look(), next_serial_read()});
    co_await life.wait_until(next);
    co_await restart_if_due(life);
    co_await read_for_sign_of_life(life);
    co_await read_serial_if_doubled(life);
  }
}

boost::asio::awaitable<void> RemoteNode::stay_silent(Life& life) {
  enter(Stage::silent);
  change_status([](NodeStatus& status) {
    note_not_booted(status);
    status.lost = true;
    status.set_nmt(NmtState::unknown);
  });
  settle_start_requests(silent_error());
  co_await pause(life, Clock::now() + kProbeInterval);
}

/// For another try, or for somebody to put it right.
boost::asio::awaitable<void> RemoteNode::wait_for_retry(Life& life, BootReport report) {
  enter(Stage::waiting);
  const bool told_by_itself = report.letter == BootResult::left_alone && !heard_.by_guarding;
  if (expectation_.left_by_itself() && restart_.at() == kNever) {
    restart_.put_off(Clock::now());  // It did not go well.
  }
  if (is_letter(report.letter)) {
    Error refused = offline_error({}, std::string(text_of(report.letter)) + ": " + report.text);
    refused.kind = ErrorKind::refused;
    settle_start_requests(refused);
    change_status([&report](NodeStatus& status) {
      status.configured = false;
      status.boot_result = report.letter;
      status.boot_text = std::move(report.text);
      status.held_back = HeldBack::no;
    });
  }
  co_await pause_and_look(life, Clock::now() + (told_by_itself ? kLookInterval : kRetryInterval));
}

/// Neither configured nor started: it left operational by itself, or somebody stopped it.
boost::asio::awaitable<void> RemoteNode::hold_back(Life& life, FoundState found) {
  enter(Stage::held);
  change_status([this, found](NodeStatus& status) {
    status.configured = false;
    if (expectation_.left_by_itself()) {
      note_left_by_itself(status);
    } else if (expectation_.held_by_command()) {
      note_not_booted(status);
    } else if (found == FoundState::stopped) {
      status.boot_result = BootResult::not_configured;
      status.held_back = HeldBack::found_stopped;
      status.boot_text = "it was found stopped; it is left so until an NMT start command or its boot-up";
    }
  });
  if (found != FoundState::stopped && !sdo_.answered()) {
    static_cast<void>(co_await sdo_.probe(kDeviceType, DataType::u32));  // Reads are let through where it answers.
  }
  const TimePoint until = std::min(Clock::now() + kRetryInterval, restart_.at());
  co_await pause_and_look(life, until);
  co_await restart_if_due(life);
}

boost::asio::awaitable<void> RemoteNode::pause_and_look(Life& life, TimePoint until) {
  while (!life.over() && Clock::now() < until) {
    const TimePoint next = std::min(until, next_serial_read());
    co_await life.wait_until(next);
    co_await read_serial_if_doubled(life);
  }
}

boost::asio::awaitable<void> RemoteNode::pause(Life& life, TimePoint until) {
  while (!life.over() && Clock::now() < until) {
    co_await life.wait_until(until);
  }
}

}  // namespace canopen
