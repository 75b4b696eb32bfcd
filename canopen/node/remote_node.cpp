#include "canopen/node/remote_node.h"

#include <utility>

#include "canopen/node/node_supervisor.h"

namespace canopen {

RemoteNode::RemoteNode(boost::asio::any_io_executor executor, Bus& bus, NodeSettings settings, NodeEvents& events)
    : supervisor_(std::make_unique<Supervisor>(std::move(executor), bus, std::move(settings), events)) {}

RemoteNode::~RemoteNode() = default;

void RemoteNode::start() {
  supervisor_->start();
}

boost::asio::awaitable<void> RemoteNode::stop() {
  return supervisor_->stop();
}

const NodeSettings& RemoteNode::settings() const noexcept {
  return supervisor_->settings();
}

const NodeStatus& RemoteNode::status() const noexcept {
  return supervisor_->status();
}

TimePoint RemoteNode::heard_until() const {
  return supervisor_->heard_until();
}

bool RemoteNode::tpdo_verified(std::uint16_t number) const noexcept {
  return supervisor_->tpdo_verified(number);
}

boost::asio::awaitable<Result<Raw>> RemoteNode::read(ObjectAddress object, DataType type, TimePoint due) {
  return supervisor_->read(object, type, due);
}

boost::asio::awaitable<Result<void>> RemoteNode::write(ObjectAddress object, DataType type, Raw raw, TimePoint deadline,
                                                       StillStands still_stands) {
  return supervisor_->write(object, type, raw, deadline, std::move(still_stands));
}

void RemoteNode::close() {
  supervisor_->close();
}

boost::asio::awaitable<Result<void>> RemoteNode::command(NmtCommand command, TimePoint deadline) {
  return supervisor_->command(command, deadline);
}

std::uint16_t RemoteNode::rpdo_of(ObjectAddress object) const noexcept {
  return supervisor_->rpdos().rpdo_of(object);
}

bool RemoteNode::rpdo_complete(std::uint16_t number, std::span<const ObjectValue> fields) const noexcept {
  return supervisor_->rpdos().complete(number, fields);
}

boost::asio::awaitable<Result<void>> RemoteNode::send_rpdo(std::uint16_t number, std::vector<ObjectValue> fields,
                                                           TimePoint deadline) {
  return supervisor_->send_rpdo(number, std::move(fields), deadline);
}

void RemoteNode::note_commanded(const ObjectValue& value) {
  supervisor_->rpdos().note(value);
}

void RemoteNode::hold_repetition(ObjectAddress object) {
  supervisor_->rpdos().hold(object);
}

void RemoteNode::forget_commanded(ObjectAddress object) {
  supervisor_->rpdos().forget(object);
}

void RemoteNode::void_rpdos(bool keep_repeating) {
  supervisor_->rpdos().make_void(keep_repeating);
}

}  // namespace canopen
