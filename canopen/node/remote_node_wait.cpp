// What the life of a node waits for: its SDO server, another try, or somebody to put it right.

#include <algorithm>
#include <string>
#include <utility>

#include "canopen/communication_objects.h"
#include "canopen/node/remote_node.h"

namespace canopen {
namespace {

// Before one that is held back, or that our frames did not reach, is looked after again.
constexpr Duration kLookAfter = std::chrono::seconds(5);
// Before one that was left alone is looked at again: only somebody else can put it right.
constexpr Duration kLookInterval = std::chrono::minutes(1);

}  // namespace

/// It goes on waiting for another try. False where it was lost meanwhile, which counts as after a boot-up; but with a
/// heartbeat that is too slow nothing is new.
boost::asio::awaitable<bool> RemoteNode::waits_on(Life& life) {
  if (std::exchange(lost_waiting_, false)) {
    const bool slow = co_await has_slow_heartbeat();
    if (life.over() || heard_.state == NmtState::operational) {
      co_return true;  // Not as it was found: it is to be found again.
    }
    if (!slow) {
      retry_at_ = {};
      co_return false;
    }
  }
  enter(Stage::waiting);
  co_await pause_and_look(life);
  co_return true;
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
  while (!life.over() && Clock::now() < next && start_requests_.empty()) {
    co_await life.wait_until(next);
  }
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
    if (sdo_.answered()) {
      patience_.settle();
    }
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
