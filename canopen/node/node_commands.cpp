// What a supervisor is asked for: SDO reads and writes, NMT commands, RPDOs.

#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/nmt_frame.h"
#include "canopen/node/node_supervisor.h"

namespace canopen {

boost::asio::awaitable<Result<Raw>> RemoteNode::Supervisor::read(ObjectAddress object, DataType type, TimePoint due) {
  if (stopping_ || !bus_.state().up()) {
    co_return offline_error(object, "the bus is down");
  }
  if (status_.nmt == NmtState::stopped) {
    co_return offline_error(object, "the drive is stopped and answers no SDO");
  }
  if (phase_ != Phase::online && !sdo_.answered()) {
    co_return offline_error(object, "the drive does not answer");
  }
  co_return co_await sdo_.read(object, type, due);
}

boost::asio::awaitable<Result<void>> RemoteNode::Supervisor::write(ObjectAddress object, DataType type, Raw raw,
                                                                   TimePoint deadline, StillStands still_stands) {
  if (!takes_commands()) {
    co_return offline_error(object, "the drive is not online and operational");
  }
  co_return co_await sdo_.write_command(object, type, raw, deadline, std::move(still_stands));
}

boost::asio::awaitable<Result<void>> RemoteNode::Supervisor::send_rpdo(std::uint16_t number,
                                                                       std::vector<ObjectValue> fields,
                                                                       TimePoint deadline) {
  if (!takes_commands()) {
    co_return offline_error({}, "the drive is not online and operational");
  }
  co_return co_await rpdos_.send(number, std::move(fields), deadline);
}

boost::asio::awaitable<Result<void>> RemoteNode::Supervisor::command(NmtCommand command, TimePoint deadline) {
  const Operation operation(*this);
  if (stopping_ || !bus_.state().up()) {
    co_return offline_error({}, "the bus is down");
  }
  if (command == NmtCommand::start && start_needs_boot()) {
    co_return co_await start_by_boot(deadline);
  }
  co_return co_await send_nmt(command, deadline);
}

boost::asio::awaitable<Result<void>> RemoteNode::Supervisor::send_nmt(NmtCommand command, TimePoint deadline) {
  const Hold before = hold_;
  const TimePoint grace_before = nmt_grace_end_;
  const bool stops = command == NmtCommand::stop || command == NmtCommand::pre_operational;
  if (stops) {
    // Before it leaves: a boot under way must not start the node after it, nor its heartbeat look like a surprise.
    hold_ = hold_ == Hold::none ? Hold::by_command : hold_;
    nmt_grace_end_ = deadline + settings_.error_control.heartbeat_timeout;
  }
  if (command != NmtCommand::start) {
    sdo_.withdraw_commands();  // Of the same queue, and behind it.
  }
  // A stop or a reset may also reach a node that has rebooted meanwhile.
  Result<void> left = co_await transmit_nmt(command, deadline, command == NmtCommand::start);
  if (stopping_) {
    co_return left;
  }
  if (left.has_error() && !left.error().outcome_unknown) {
    if (stops && hold_ == Hold::by_command) {
      hold_ = before;
      nmt_grace_end_ = grace_before;
    }
    Error not_sent = left.error();
    not_sent.node = settings_.node;
    co_return not_sent;
  }
  on_nmt_left(command);
  co_return left;
}

RemoteNode::Supervisor::NmtSending::NmtSending(Supervisor& owner, NmtCommand command, TimePoint deadline,
                                               bool of_this_life)
    : owner_(owner),
      transmission_(owner.bus_, TransmitClass::nmt, nmt_frame(command, owner.settings_.node), deadline),
      of_this_life_(of_this_life) {
  owner_.nmt_sendings_.push_back(this);
}

void RemoteNode::Supervisor::NmtSending::withdraw() {
  withdrawn_ = true;
  transmission_.withdraw();
}

boost::asio::awaitable<Result<void>> RemoteNode::Supervisor::transmit_nmt(NmtCommand command, TimePoint deadline,
                                                                          bool of_this_life) {
  NmtSending sending(*this, command, deadline, of_this_life);
  Result<void> left = co_await sending.result();
  if (left.has_error() && !left.error().outcome_unknown && sending.withdrawn()) {
    co_return offline_error({}, "withdrawn: the drive was lost, rebooted or removed");
  }
  co_return left;
}

void RemoteNode::Supervisor::withdraw_nmt(bool all) {
  for (NmtSending* sending : nmt_sendings_) {
    if (all || sending->of_this_life()) {
      sending->withdraw();
    }
  }
}

void RemoteNode::Supervisor::on_nmt_left(NmtCommand command) {
  switch (command) {
    case NmtCommand::start:
      hold_ = Hold::none;
      nmt_grace_end_ = Clock::now() + settings_.error_control.heartbeat_timeout;
      break;
    case NmtCommand::stop:
    case NmtCommand::pre_operational:
      nmt_grace_end_ = Clock::now() + settings_.error_control.heartbeat_timeout;
      withdraw_commands();
      break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      // What follows is a boot-up, even where the drive sends no message of it.
      hold_ = Hold::none;
      nmt_grace_end_ = Clock::now() + settings_.error_control.heartbeat_timeout;
      signs_ = NodeSigns{};
      watch_.suspend();
      leave_service();
      change_status([](NodeStatus& status) {
        status.online = false;
        status.configured = false;
        status.nmt = NmtState::unknown;
        status.boot_result = kNotBooted;
        status.boot_text.clear();
      });
      break;
  }
}

bool RemoteNode::Supervisor::takes_commands() const {
  // After an NMT stop the heartbeat still says operational for a while.
  return phase_ == Phase::online && status_.nmt == NmtState::operational && hold_ == Hold::none;
}

bool RemoteNode::Supervisor::start_needs_boot() const {
  if (phase_ == Phase::online) {
    return hold_ == Hold::by_itself;  // It may have rebooted unseen.
  }
  return phase_ != Phase::starting && signs_.state != NmtState::operational;
}

boost::asio::awaitable<Result<void>> RemoteNode::Supervisor::start_by_boot(TimePoint deadline) {
  if (status_.lost) {
    co_return offline_error({}, "the drive is silent; it is booted and started when it appears");
  }
  const Hold held = std::exchange(hold_, Hold::none);
  start_requested_ = true;
  ++starts_awaited_;
  if (phase_ == Phase::online) {
    leave_service();
    change_status([](NodeStatus& status) {
      status.online = false;
      status.configured = false;
      status.boot_result = kNotBooted;
      status.boot_text.clear();
    });
  }
  changed_.notify();
  const std::uint32_t before = starts_;
  while (starts_ == before && Clock::now() < deadline && !stopping_) {
    co_await changed_.wait_until(deadline);
  }
  --starts_awaited_;
  if (starts_ != before) {
    co_return Result<void>();
  }
  if (stopping_) {
    co_return offline_error({}, "removed while it was booted");
  }
  Error error = offline_error({}, "the drive is still being booted, which ends with NMT start");
  error.kind = ErrorKind::timeout;
  error.outcome_unknown = true;
  const bool begun = !start_requested_ || phase_ == Phase::booting || phase_ == Phase::starting;
  if (!begun && held != Hold::none && hold_ == Hold::none && starts_awaited_ == 0) {
    hold_ = held;
    start_requested_ = false;
    error.outcome_unknown = false;
    error.detail = "not begun: the drive's state was not known in time";
  }
  co_return error;
}

Error RemoteNode::Supervisor::offline_error(ObjectAddress object, std::string detail) const {
  Error error;
  error.kind = ErrorKind::offline;
  error.node = settings_.node;
  error.object = object;
  error.detail = std::move(detail);
  return error;
}

}  // namespace canopen
