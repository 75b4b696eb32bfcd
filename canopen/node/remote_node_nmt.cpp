// What a node is told to be by NMT: commands, and starts that need a boot first.

#include <utility>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/bus/transmission.h"
#include "canopen/nmt_frame.h"
#include "canopen/node/remote_node.h"
#include "canopen/node/remote_node_operation.h"

namespace canopen {

/// An NMT command under way, where withdraw_nmt() finds it.
class RemoteNode::NmtSending {
 public:
  NmtSending(RemoteNode& owner, NmtCommand command, TimePoint deadline, bool of_this_life)
      : owner_(owner),
        command_(command),
        of_this_life_(of_this_life),
        transmission_(owner.bus_, TransmitClass::nmt, nmt_frame(command, owner.settings_.node), deadline,
                      [this] { on_left(); }) {
    owner_.nmt_sendings_.push_back(this);
  }
  ~NmtSending() { std::erase(owner_.nmt_sendings_, this); }
  NmtSending(const NmtSending&) = delete;
  NmtSending& operator=(const NmtSending&) = delete;

  boost::asio::awaitable<Result<void>> result() { return transmission_.result(); }
  void withdraw(NmtGroup why) {
    withdrawn_ = true;
    life_over_ = life_over_ || why != NmtGroup::starts;
    transmission_.withdraw();
  }
  [[nodiscard]] bool withdrawn() const noexcept { return withdrawn_; }
  [[nodiscard]] bool is_of(NmtGroup group) const noexcept {
    return group == NmtGroup::starts ? command_ == NmtCommand::start : of_this_life_;
  }

 private:
  /// What it was told to be, but for the pre-operational of a boot, counts from here on.
  void on_left() {
    if (!life_over_ && (command_ == NmtCommand::start || !of_this_life_)) {
      owner_.expectation_.leave(command_, Clock::now());
    }
  }

  RemoteNode& owner_;
  NmtCommand command_;
  bool of_this_life_;
  bool withdrawn_ = false;
  bool life_over_ = false;     ///< It is for a node that has rebooted or was lost.
  Transmission transmission_;  ///< The last: it may tell at once.
};

boost::asio::awaitable<Result<void>> RemoteNode::command(NmtCommand command, TimePoint deadline) {
  const Operation operation(*this);
  if (stopping_ || !bus_.state().up()) {
    co_return offline_error({}, "the bus is down");
  }
  if (command != NmtCommand::start) {
    co_return co_await send_nmt(command, deadline);
  }
  Result<void> started;
  if (start_needs_boot()) {
    started = co_await start_by_boot(deadline);
  } else {
    started = co_await send_nmt(command, deadline);
  }
  if (started.has_value()) {
    doubled_.end();  // Whoever had it started wants to see what is left of it.
  }
  co_return started;
}

boost::asio::awaitable<Result<void>> RemoteNode::send_nmt(NmtCommand command, TimePoint deadline) {
  const bool starts = command == NmtCommand::start;
  const NmtExpectation before = expectation_;
  const Restart restart_before = restart_;
  expectation_.give(command, deadline);
  const NmtExpectation given = expectation_;
  if (!starts) {
    restart_.end();
    hold_reason_.clear();
    settle_start_requests(withdrawn_error());  // It was the older wish.
    withdraw_nmt(NmtGroup::starts);
    sdo_.withdraw_commands();  // Of the same queue, and behind it.
  }
  // A stop or a reset may also reach a node that has rebooted meanwhile.
  doubled_.on_nmt(command);
  NmtSending sending(*this, command, deadline, starts);
  Result<void> left = co_await sending.result();
  doubled_.on_nmt(command);
  if (stopping_ || (starts && sending.withdrawn())) {
    co_return left.has_error() && !left.error().outcome_unknown ? withdrawn_error() : left;
  }
  if (left.has_error() && !left.error().outcome_unknown) {
    if (expectation_ == given) {
      expectation_ = before;
      restart_.resume(restart_before);
      if (stage_ == Stage::serving && status_.nmt != NmtState::operational) {
        end_life();  // Its boot may have ended without a start for the sake of this command.
      }
    }
    Error not_sent = left.error();
    not_sent.node = settings_.node;
    co_return not_sent;
  }
  if (left.has_error()) {
    expectation_.leave(command, Clock::now());  // It may have.
  }
  on_nmt_left(command);
  co_return left;
}

boost::asio::awaitable<Result<void>> RemoteNode::transmit_nmt(NmtCommand command, TimePoint deadline) {
  doubled_.on_nmt(command);
  NmtSending sending(*this, command, deadline, true);
  const Result<void> left = co_await sending.result();
  doubled_.on_nmt(command);
  co_return left;
}

void RemoteNode::withdraw_nmt(NmtGroup which) {
  for (NmtSending* sending : nmt_sendings_) {
    if (which == NmtGroup::all || sending->is_of(which)) {
      sending->withdraw(which);
    }
  }
}

void RemoteNode::on_nmt_left(NmtCommand command) {
  switch (command) {
    case NmtCommand::start:
      heard_.stopped_by_us = false;
      change_status([](NodeStatus& status) { status.commanded.reset(); });
      break;
    case NmtCommand::stop:
    case NmtCommand::pre_operational:
      heard_.tpdo_at.reset();
      if (command == NmtCommand::pre_operational && std::exchange(heard_.stopped_by_us, false)) {
        heard_.state.reset();
        end_life();  // Made pre-operational it answers again.
      }
      withdraw_commands();
      change_status([command](NodeStatus& status) {
        if (status.nmt != NmtState::unknown) {
          status.commanded = command == NmtCommand::stop ? NmtState::stopped : NmtState::pre_operational;
        }
      });
      if (expectation_.left()) {
        change_status([this](NodeStatus& status) { note_left_by_itself(status); });
      }
      break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      // What follows is a boot-up, even where the drive sends no message of it.
      heard_ = Heard{};
      half_done_.clear();
      hold_reason_.clear();
      restart_.begin_anew();
      retry_.begin_anew();
      patience_.expect_boot_up();
      self_start_due_ = true;
      watch_.suspend();
      guarding_.stop();
      guarding_.begin_anew();
      end_life();
      change_status([](NodeStatus& status) {
        note_not_booted(status);
        status.set_nmt(NmtState::unknown);
      });
      break;
  }
}

/// Or another look. Not where it is served and did what it was told, or is about to be started anyhow.
bool RemoteNode::start_needs_boot() const {
  return stage_ == Stage::serving ? expectation_.left() : stage_ != Stage::starting;
}

boost::asio::awaitable<Result<void>> RemoteNode::start_by_boot(TimePoint deadline) {
  if (status_.lost && (stage_ == Stage::silent || stage_ == Stage::searching)) {
    co_return silent_error();
  }
  StartRequest request;
  start_requests_.push_back(&request);
  restart_.begin_anew();
  retry_.begin_anew();
  retry_at_ = {};
  if (stage_ == Stage::serving) {
    change_status([](NodeStatus& status) { note_not_booted(status); });
  }
  if (stage_ != Stage::searching && stage_ != Stage::configuring && stage_ != Stage::inspecting) {
    end_life();
  }
  changed_.notify();  // Where it is waited for the drive's SDO server, it is tried at once.
  while (!request.result && Clock::now() < deadline) {
    co_await changed_.wait_until(deadline);
  }
  std::erase(start_requests_, &request);
  if (request.result) {
    co_return *request.result;
  }
  Error error = offline_error({}, "not begun: the drive's state was not known in time");
  error.kind = ErrorKind::timeout;
  if (stage_ == Stage::configuring || stage_ == Stage::starting) {
    error.outcome_unknown = true;
    error.detail = "the drive is still being booted, which ends with NMT start";
  }
  co_return error;
}

void RemoteNode::settle_start_requests(const Result<void>& result) {
  for (StartRequest* request : start_requests_) {
    request->result = result;
  }
  start_requests_.clear();
  changed_.notify();
}

void RemoteNode::take_start_requests() {
  if (!start_requests_.empty()) {
    expectation_.want_start();
  }
}

Error RemoteNode::silent_error() const {
  return offline_error({}, "the drive is silent; it is booted and started when it appears");
}

Error RemoteNode::withdrawn_error() const {
  return offline_error({}, "withdrawn: the drive was lost, rebooted or removed, or a stop came");
}

}  // namespace canopen
