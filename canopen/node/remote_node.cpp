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
  if (found != FoundState::operational && Clock::now() < retry_at_) {
    const bool nothing_new = co_await waits_on(life);
    if (nothing_new) {
      co_return;
    }
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
  patience_.expect_boot_up();
  co_await pause(life, Clock::now() + kProbeInterval);
}

}  // namespace canopen
