#include "bridges/process/command_sender.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "canopen/node/remote_node.h"

namespace process {
namespace {

using boost::asio::awaitable;
using canopen::Error;
using canopen::ErrorKind;

// CiA 301 table 22: what a drive answers that does not take a mapped object by SDO at all.
bool takes_no_sdo(const Error& error) {
  constexpr std::array kCodes{0x06010000U, 0x06010002U, 0x06020000U, 0x06090011U};
  return error.kind == ErrorKind::refused && std::find(kCodes.begin(), kCodes.end(), error.abort) != kCodes.end();
}

// The drive still holds what it held before.
bool left_unchanged(const Error& error) {
  const bool not_begun = error.kind == ErrorKind::timeout || error.kind == ErrorKind::incomplete;
  return error.kind == ErrorKind::refused || (not_begun && !error.outcome_unknown);
}

}  // namespace

awaitable<Outcome> CommandSender::send(WriteStep step, std::uint32_t knowledge, canopen::TimePoint deadline,
                                       StillStands still_stands) {
  if (step.rpdo != 0) {
    return send_rpdo(std::move(step), knowledge, deadline);
  }
  return send_sdo(step.fields.front(), knowledge, deadline, std::move(still_stands));
}

awaitable<Outcome> CommandSender::send_rpdo(WriteStep step, std::uint32_t knowledge, canopen::TimePoint deadline) {
  std::vector<canopen::ObjectValue> values;
  for (const Field& field : step.fields) {
    values.push_back(object_value(model_, field));
  }
  Outcome outcome = co_await node_.send_rpdo(step.rpdo, std::move(values), deadline);
  if (outcome.has_error()) {
    co_return outcome;
  }
  make_void_again(knowledge);
  for (const Field& field : step.fields) {
    const config::Signal& signal = model_.signals[field.signal];
    if (config::is_momentary(signal, field.raw)) {
      node_.forget_commanded(signal.object);
    }
  }
  co_return outcome;
}

awaitable<Outcome> CommandSender::send_sdo(Field field, std::uint32_t knowledge, canopen::TimePoint deadline,
                                           StillStands still_stands) {
  const config::Signal& signal = model_.signals[field.signal];
  node_.hold_repetition(signal.object);
  Outcome outcome = co_await node_.write(signal.object, signal.type, field.raw, deadline, std::move(still_stands));
  if (outcome.has_error()) {
    if (!left_unchanged(outcome.error())) {
      node_.forget_commanded(signal.object);
    }
    co_return explain(outcome.error(), signal.object);
  }
  if (config::is_momentary(signal, field.raw)) {
    node_.forget_commanded(signal.object);
    co_return outcome;
  }
  // Also where it will not count: an RPDO that is being repeated must not undo it.
  node_.note_commanded(object_value(model_, field));
  make_void_again(knowledge);
  co_return outcome;
}

void CommandSender::make_void(bool keep_repeating) {
  ++knowledge_;
  if (!keep_repeating) {
    silenced_ = knowledge_;
  }
  node_.void_rpdos(keep_repeating);
}

void CommandSender::make_void_again(std::uint32_t knowledge) {
  if (knowledge == knowledge_) {
    return;
  }
  // After a fault a run command of before must not go on being repeated: it would start the motor once the fault is
  // reset at the drive.
  const bool silenced_since = silenced_ > knowledge;
  node_.void_rpdos(!silenced_since);
}

/// Where an object can be commanded by its RPDO only, the abort alone would not tell what to do.
Error CommandSender::explain(Error error, canopen::ObjectAddress object) const {
  const std::uint16_t rpdo = node_.rpdo_of(object);
  if (rpdo == 0 || !takes_no_sdo(error)) {
    return error;
  }
  error.kind = ErrorKind::incomplete;
  error.detail = "RPDO" + std::to_string(rpdo) +
                 " is not complete, and the drive takes no single write of this object; " +
                 completion_text(model_, rpdo);
  return error;
}

}  // namespace process
