// What a node is asked for: SDO reads and writes, NMT commands, RPDOs.

#include <algorithm>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/bus/transmission.h"
#include "canopen/nmt_frame.h"
#include "canopen/node/motor_check.h"
#include "canopen/node/remote_node.h"

namespace canopen {

/// An NMT command under way, where withdraw_nmt() finds it.
class RemoteNode::NmtSending {
 public:
  NmtSending(RemoteNode& owner, NmtCommand command, TimePoint deadline, bool of_this_life)
      : owner_(owner),
        transmission_(owner.bus_, TransmitClass::nmt, nmt_frame(command, owner.settings_.node), deadline),
        of_this_life_(of_this_life) {
    owner_.nmt_sendings_.push_back(this);
  }
  ~NmtSending() { std::erase(owner_.nmt_sendings_, this); }
  NmtSending(const NmtSending&) = delete;
  NmtSending& operator=(const NmtSending&) = delete;

  boost::asio::awaitable<Result<void>> result() { return transmission_.result(); }
  void withdraw() {
    withdrawn_ = true;
    transmission_.withdraw();
  }
  [[nodiscard]] bool withdrawn() const noexcept { return withdrawn_; }
  [[nodiscard]] bool of_this_life() const noexcept { return of_this_life_; }

 private:
  RemoteNode& owner_;
  Transmission transmission_;
  bool of_this_life_;
  bool withdrawn_ = false;
};

/// Counts what is done for a caller, so that stop() can wait for its end.
class RemoteNode::Operation {
 public:
  explicit Operation(RemoteNode& owner) : owner_(owner) { ++owner_.operations_; }
  ~Operation() {
    --owner_.operations_;
    owner_.ended_.notify();
  }
  Operation(const Operation&) = delete;
  Operation& operator=(const Operation&) = delete;

 private:
  RemoteNode& owner_;
};

TimePoint RemoteNode::heard_until() const {
  return bus_.heard_until();
}

bool RemoteNode::tpdo_verified(std::uint16_t number) const noexcept {
  return std::find(verified_tpdos_.begin(), verified_tpdos_.end(), number) != verified_tpdos_.end();
}

boost::asio::awaitable<Result<Raw>> RemoteNode::read(ObjectAddress object, DataType type, TimePoint due) {
  if (stopping_ || !bus_.state().up()) {
    co_return offline_error(object, "the bus is down");
  }
  if (status_.nmt == NmtState::stopped) {
    co_return offline_error(object, "the drive is stopped and answers no SDO");
  }
  if (stage_ != Stage::serving && !sdo_.answered()) {
    co_return offline_error(object, "the drive does not answer");
  }
  co_return co_await sdo_.read(object, type, due);
}

boost::asio::awaitable<Result<void>> RemoteNode::write(ObjectAddress object, DataType type, Raw raw, TimePoint deadline,
                                                       StillStands still_stands) {
  if (!takes_commands()) {
    co_return offline_error(object, "the drive is not online and operational");
  }
  co_return co_await sdo_.write_command(object, type, raw, deadline, std::move(still_stands));
}

boost::asio::awaitable<Result<void>> RemoteNode::send_rpdo(std::uint16_t number, std::vector<ObjectValue> fields,
                                                           TimePoint deadline) {
  if (!takes_commands()) {
    co_return offline_error({}, "the drive is not online and operational");
  }
  co_return co_await outputs_.send(number, std::move(fields), deadline);
}

boost::asio::awaitable<Result<void>> RemoteNode::command(NmtCommand command, TimePoint deadline) {
  const Operation operation(*this);
  if (stopping_ || !bus_.state().up()) {
    co_return offline_error({}, "the bus is down");
  }
  if (command == NmtCommand::start && start_needs_boot()) {
    co_return co_await start_by_boot(deadline);
  }
  co_return co_await send_nmt(command, deadline);
}

boost::asio::awaitable<Result<void>> RemoteNode::send_nmt(NmtCommand command, TimePoint deadline) {
  const NmtExpectation before = expectation_;
  expectation_.give(command, deadline);
  const NmtExpectation given = expectation_;
  if (command != NmtCommand::start) {
    sdo_.withdraw_commands();  // Of the same queue, and behind it.
  }
  // A stop or a reset may also reach a node that has rebooted meanwhile.
  Result<void> left = co_await transmit_nmt(command, deadline, command == NmtCommand::start);
  if (stopping_) {
    co_return left;
  }
  if (left.has_error() && !left.error().outcome_unknown) {
    if (expectation_ == given) {
      expectation_ = before;
    }
    Error not_sent = left.error();
    not_sent.node = settings_.node;
    co_return not_sent;
  }
  on_nmt_left(command);
  co_return left;
}

boost::asio::awaitable<std::optional<bool>> RemoteNode::motor_runs() {
  const Operation operation(*this);
  co_return co_await read_running(sdo_, settings_.motor);
}

boost::asio::awaitable<Result<void>> RemoteNode::transmit_nmt(NmtCommand command, TimePoint deadline,
                                                              bool of_this_life) {
  NmtSending sending(*this, command, deadline, of_this_life);
  Result<void> left = co_await sending.result();
  if (left.has_error() && !left.error().outcome_unknown && sending.withdrawn()) {
    co_return offline_error({}, "withdrawn: the drive was lost, rebooted or removed");
  }
  co_return left;
}

void RemoteNode::withdraw_nmt(bool all) {
  for (NmtSending* sending : nmt_sendings_) {
    if (all || sending->of_this_life()) {
      sending->withdraw();
    }
  }
}

void RemoteNode::on_nmt_left(NmtCommand command) {
  expectation_.leave(command, Clock::now());
  switch (command) {
    case NmtCommand::start:
      break;
    case NmtCommand::stop:
    case NmtCommand::pre_operational:
      withdraw_commands();
      break;
    case NmtCommand::reset_node:
    case NmtCommand::reset_communication:
      // What follows is a boot-up, even where the drive sends no message of it.
      heard_ = Heard{};
      watch_.suspend();
      end_life(LifeEnd::reset);
      change_status([](NodeStatus& status) {
        note_not_booted(status);
        status.nmt = NmtState::unknown;
      });
      break;
  }
}

void RemoteNode::withdraw_commands() {
  outputs_.cease();
  sdo_.withdraw_commands();
}

bool RemoteNode::takes_commands() const {
  // After an NMT stop the heartbeat still says operational for a while.
  return stage_ == Stage::serving && status_.nmt == NmtState::operational && expectation_.may_start();
}

bool RemoteNode::start_needs_boot() const {
  switch (stage_) {
    case Stage::serving:
      return expectation_.left_by_itself();  // It may have rebooted unseen.
    case Stage::starting:
      return false;
    case Stage::waiting:
      return true;  // Where it runs it is looked at again.
    default:
      return heard_.state != NmtState::operational;
  }
}

boost::asio::awaitable<Result<void>> RemoteNode::start_by_boot(TimePoint deadline) {
  if (status_.lost) {
    co_return offline_error({}, "the drive is silent; it is booted and started when it appears");
  }
  const NmtExpectation before = expectation_;
  expectation_.release();
  const NmtExpectation released = expectation_;
  restart_.begin_anew();
  StartRequest request;
  start_requests_.push_back(&request);
  if (stage_ == Stage::serving) {
    change_status([](NodeStatus& status) { note_not_booted(status); });
  }
  if (stage_ != Stage::searching && stage_ != Stage::configuring) {
    end_life(LifeEnd::wanted);
  }
  while (!request.result && Clock::now() < deadline) {
    co_await changed_.wait_until(deadline);
  }
  std::erase(start_requests_, &request);
  if (request.result) {
    co_return *request.result;
  }
  Error error = offline_error({}, "the drive is still being booted, which ends with NMT start");
  error.kind = ErrorKind::timeout;
  error.outcome_unknown = true;
  if (!request.begun && expectation_ == released && start_requests_.empty()) {
    expectation_ = before;
    error.outcome_unknown = false;
    error.detail = "not begun: the drive's state was not known in time";
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

Error RemoteNode::offline_error(ObjectAddress object, std::string detail) const {
  Error error;
  error.kind = ErrorKind::offline;
  error.node = settings_.node;
  error.object = object;
  error.detail = std::move(detail);
  return error;
}

}  // namespace canopen
