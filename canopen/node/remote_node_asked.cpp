// What a node is asked for: SDO reads and writes, RPDOs.

#include <algorithm>
#include <utility>

#include "canopen/bus/bus.h"
#include "canopen/node/motor_check.h"
#include "canopen/node/remote_node.h"
#include "canopen/node/remote_node_operation.h"

namespace canopen {

TimePoint RemoteNode::heard_until() const {
  return bus_.heard_until();
}

bool RemoteNode::tpdo_verified(std::uint16_t number) const noexcept {
  return std::find(verified_tpdos_.begin(), verified_tpdos_.end(), number) != verified_tpdos_.end();
}

std::optional<Error> RemoteNode::why_unreadable(ObjectAddress object) const {
  if (stopping_ || !bus_.state().up()) {
    return offline_error(object, "the bus is down");
  }
  if (status_.nmt == NmtState::stopped) {
    return offline_error(object, "the drive is stopped and answers no SDO");
  }
  if (stage_ != Stage::serving && !sdo_.answered()) {
    return offline_error(object, "the drive does not answer");
  }
  return std::nullopt;
}

boost::asio::awaitable<Result<Raw>> RemoteNode::read(ObjectAddress object, DataType type, TimePoint due) {
  if (const std::optional<Error> refused = why_unreadable(object)) {
    co_return *refused;
  }
  co_return co_await sdo_.read(object, type, due);
}

boost::asio::awaitable<Result<std::vector<std::uint8_t>>> RemoteNode::read_bytes(ObjectAddress object,
                                                                                 std::size_t expected) {
  if (const std::optional<Error> refused = why_unreadable(object)) {
    co_return *refused;
  }
  co_return co_await sdo_.read_bytes(object, expected);
}

boost::asio::awaitable<Result<void>> RemoteNode::write(ObjectAddress object, DataType type, Raw raw,
                                                       TimePoint deadline) {
  if (!takes_commands()) {
    co_return not_in_service(object);
  }
  co_return co_await sdo_.write_command(object, type, raw, deadline);
}

boost::asio::awaitable<Result<void>> RemoteNode::write_bytes(ObjectAddress object, std::vector<std::uint8_t> data,
                                                             TimePoint deadline) {
  if (!takes_commands()) {
    co_return not_in_service(object);
  }
  co_return co_await sdo_.write_command(object, data, deadline);
}

boost::asio::awaitable<Result<void>> RemoteNode::write_stop(ObjectAddress object, DataType type, Raw raw,
                                                            TimePoint deadline, const StopLimit& limit) {
  const Operation operation(*this);
  if (stopping_ || !bus_.state().up()) {
    co_return offline_error(object, "the bus is down");
  }
  const bool in_service = takes_commands();
  const unsigned most_sent = in_service ? SdoClient::kStopsSent : 1;
  Result<void> result = co_await sdo_.write_stop(object, type, raw, deadline, most_sent, limit);
  if (result.has_error() && result.error().kind == ErrorKind::timeout && !(in_service && takes_commands())) {
    Error told = result.error();
    told.kind = ErrorKind::offline;
    result = told;
  }
  co_return result;
}

boost::asio::awaitable<Result<Raw>> RemoteNode::read_for_stop(ObjectAddress object, DataType type, TimePoint deadline,
                                                              const StopLimit& limit) {
  const Operation operation(*this);
  if (!takes_commands()) {
    co_return offline_error(object, "the drive is not online and operational");
  }
  co_return co_await sdo_.read_for_stop(object, type, deadline, limit);
}

boost::asio::awaitable<Result<void>> RemoteNode::send_rpdo(std::uint16_t number, std::vector<ObjectValue> values,
                                                           TransmitClass transmit_class, TimePoint deadline) {
  if (!takes_commands()) {
    co_return not_in_service({});
  }
  co_return co_await outputs_.send(number, std::move(values), transmit_class, deadline);
}

void RemoteNode::withdraw_command() {
  outputs_.withdraw();
  sdo_.withdraw_commands();
}

boost::asio::awaitable<std::optional<bool>> RemoteNode::motor_runs() {
  const Operation operation(*this);
  co_return co_await read_running(sdo_, settings_.motor);
}

void RemoteNode::withdraw_commands() {
  outputs_.cease();
  sdo_.withdraw_commands();
}

bool RemoteNode::takes_commands() const {
  // After an NMT stop the heartbeat still says operational for a while.
  return stage_ == Stage::serving && status_.nmt == NmtState::operational && expectation_.may_start() &&
         status_.doubled != Doubled::proof;
}

Error RemoteNode::not_in_service(ObjectAddress object) const {
  Error refused =
      offline_error(object, status_.doubled == Doubled::proof ? "two nodes have its node id: no commands but stops"
                                                              : "the drive is not online and operational");
  refused.not_sent = true;
  return refused;
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
