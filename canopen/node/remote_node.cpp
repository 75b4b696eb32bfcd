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
// Before one that is held back, or that our frames did not reach, is looked after again.
constexpr Duration kLookAfter = std::chrono::seconds(5);
// Before one that was left alone is looked at again: only somebody else can put it right.
constexpr Duration kLookInterval = std::chrono::minutes(1);
// Keeps a life that fails at once, as with a full transmit queue, from spinning.
constexpr Duration kBreath = std::chrono::milliseconds(10);

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
      restart_(settings_.restart),
      patience_(settings_.sdo.patience) {
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
  } else if (Clock::now() < retry_at_) {
    enter(Stage::waiting);  // It was missing meanwhile, as with a heartbeat that is too slow: nothing is new.
    co_await pause_and_look(life);
    co_return;
  } else if (found != FoundState::not_asked) {
    report = co_await boot(context(life), found);
  }
  if (life.over()) {
    co_return;
  }
  if (stage_ == Stage::serving) {
    settle_start_requests({});
    co_await serve(life);
  } else if (is_letter(report.letter) && !sdo_.answered() && patience_.lasts(Clock::now())) {
    co_await wait_for_answers(life);
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
  retry_at_ = {};  // Where it appears now, it begins anew.
  co_await pause(life, Clock::now() + kProbeInterval);
}

/// It has booted, and its SDO server may wake up later: no letter yet, and the boot counts as under way.
boost::asio::awaitable<void> RemoteNode::wait_for_answers(Life& life) {
  const TimePoint now = Clock::now();
  if (patience_.to_be_told()) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(patience_.until() - now);
    events_.on_remark("its SDO server is silent after the boot-up; it has " + std::to_string(left.count()) +
                      " ms more (sdo.patience)");
  }
  const TimePoint next = patience_.next_try(now);
  co_await pause(life, next);
}

/// For another try, or for somebody to put it right.
boost::asio::awaitable<void> RemoteNode::wait_for_retry(Life& life, BootReport report) {
  enter(Stage::waiting);
  Duration pause = kLookAfter;
  if (report.letter == BootResult::left_alone && !heard_.by_guarding) {
    pause = kLookInterval;
  } else if (is_letter(report.letter) && !expectation_.left_by_itself()) {  // Else restart_ decides.
    pause = retry_.after(report.letter, report.cause.empty() ? report.text : report.cause);
  }
  if (expectation_.left_by_itself() && restart_.at() == kNever) {
    restart_.put_off(Clock::now());  // It did not go well.
  }
  if (is_letter(report.letter)) {
    Error refused = offline_error({}, std::string(text_of(report.letter, report.held_back)) + ": " + report.text);
    refused.kind = ErrorKind::refused;
    settle_start_requests(refused);
    change_status([&report](NodeStatus& status) {
      status.configured = false;
      status.boot_result = report.letter;
      status.boot_text = std::move(report.text);
      status.held_back = report.held_back;
    });
  }
  retry_at_ = Clock::now() + pause;
  co_await pause_and_look(life);
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
  retry_at_ = std::min(Clock::now() + kLookAfter, restart_.at());
  co_await pause_and_look(life);
  co_await restart_if_due(life);
}

boost::asio::awaitable<void> RemoteNode::pause_and_look(Life& life) {
  TimePoint look_at = Clock::now() + kLookAfter;
  while (!life.over() && Clock::now() < retry_at_) {
    const TimePoint next = std::min({retry_at_, next_serial_read(), look_at});
    co_await life.wait_until(next);
    co_await read_serial_if_doubled(life);
    if (life.over() || Clock::now() < look_at || Clock::now() >= retry_at_) {
      continue;
    }
    look_at = Clock::now() + kLookAfter;
    const bool looked_at_each_minute = status_.boot_result == BootResult::left_alone && !heard_.by_guarding;
    if (!looked_at_each_minute && (heard_.by_guarding || !heard_.heartbeat_at)) {  // Nothing comes unasked.
      const Result<Raw> answer = co_await sdo_.probe(kDeviceType, DataType::u32);
      if (answer.has_error() && answer.error().kind == ErrorKind::timeout && !answer.error().not_sent) {
        co_return;
      }
    }
  }
}

boost::asio::awaitable<void> RemoteNode::pause(Life& life, TimePoint until) {
  while (!life.over() && Clock::now() < until) {
    co_await life.wait_until(until);
  }
}

}  // namespace canopen
