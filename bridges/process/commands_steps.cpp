// How a command that has its turn is carried out, and what makes it void.

#include <algorithm>
#include <utility>

#include "bridges/process/command_checks.h"
#include "bridges/process/commands.h"
#include "canopen/node/remote_node.h"

namespace process {
namespace {

using boost::asio::awaitable;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

// The drive still holds what it held before.
bool left_unchanged(const Error& error) {
  const bool not_begun = error.kind == ErrorKind::timeout || error.kind == ErrorKind::incomplete;
  return error.not_sent || error.kind == ErrorKind::refused || (not_begun && !error.outcome_unknown);
}

std::vector<SignalId> signals_of(std::span<const Field> fields) {
  std::vector<SignalId> signals;
  for (const Field& field : fields) {
    signals.push_back(field.signal);
  }
  std::sort(signals.begin(), signals.end());
  return signals;
}

}  // namespace

awaitable<Outcome> Commands::carry_out(PendingCommand& command, std::vector<Field> remaining) {
  while (!remaining.empty()) {
    // A stop that came meanwhile goes first, whatever this writes.
    while (!stops_.empty() && !closed_ && canopen::Clock::now() < command.deadline) {
      co_await changed_.wait_until(command.deadline);
    }
    if (Refusal refused = refuse_waiting(command)) {
      co_return with_written(*std::move(refused), command.written_names);
    }
    if (canopen::Clock::now() >= command.deadline) {
      co_return with_written(*refuse_for_time(command), command.written_names);
    }
    if (const auto unsendable = first_unsendable(model_, commanded_, remaining)) {
      co_return with_written(incomplete(*unsendable), command.written_names);
    }
    if (command.record.writes_control && !command.noted) {
      co_await note_begin(command);
      continue;  // It may not stand any more.
    }
    Outcome outcome = co_await take_step(command, remaining);
    if (outcome.has_error()) {
      co_return with_written(outcome.error(), command.written_names);
    }
  }
  co_return Outcome();
}

awaitable<Outcome> Commands::take_step(PendingCommand& command, std::vector<Field>& remaining) {
  const WriteStep step = next_step(commanded_, remaining);
  command.withdrawn = false;
  Result<void> sent = Error{};
  if (step.rpdo != 0) {
    sent = co_await send_rpdo(command, step, {});
  } else {
    sent = co_await send_sdo(command, step.fields.front(), false);
  }
  command.carries_control = false;
  if (sent.has_value()) {
    take_out(command, remaining, step.fields);
    co_return Outcome();
  }
  if (sent.error().not_sent && std::exchange(command.withdrawn, false)) {
    co_return Outcome();  // It is looked at again.
  }
  co_return explain(sent.error(), step.fields.front().signal);
}

awaitable<Result<void>> Commands::send_rpdo(PendingCommand& command, const WriteStep& step,
                                            std::span<const Field> borrowed) {
  std::vector<Field> given = step.fields;
  given.insert(given.end(), borrowed.begin(), borrowed.end());
  std::optional<std::vector<canopen::ObjectValue>> values = commanded_.values(step.rpdo, given);
  if (!values) {
    co_return error(ErrorKind::incomplete, completion_text(model_, step.rpdo));
  }
  const bool stops = command.use == ControlUse::stop;
  const Commanded::Epoch since = commanded_.epoch();
  command.carries_control = commanded_.control() && commanded_.rpdo_of(*commanded_.control()) == step.rpdo;
  const Result<void> left = co_await node_.send_rpdo(
      step.rpdo, *std::move(values), stops ? canopen::TransmitClass::stop : canopen::TransmitClass::command,
      command.deadline);
  account(command, step, since, left);
  co_return left;
}

awaitable<Result<void>> Commands::send_sdo(PendingCommand& command, const Field& field, bool as_stop) {
  const WriteStep step{0, {field}};
  const config::Signal& signal = model_.signals[field.signal];
  const Commanded::Epoch since = commanded_.epoch();
  command.carries_control = commanded_.is_control(field.signal);
  node_.hold_repetition(signal.object);
  Result<void> written = Error{};
  if (as_stop) {
    written = co_await node_.write_stop(signal.object, signal.type, field.raw, command.deadline, command.stop_limit);
  } else {
    written = co_await node_.write(signal.object, signal.type, field.raw, command.deadline);
  }
  account(command, step, since, written);
  // A stop behind it holds the same RPDO, and refreshes it when it is through itself.
  if (as_stop || !command.carries_control || stops_.empty()) {
    node_.refresh_repetition(signal.object);
  }
  co_return written;
}

/// What a step has left behind.
void Commands::account(PendingCommand& command, const WriteStep& step, Commanded::Epoch since,
                       const Result<void>& result) {
  const canopen::TimePoint now = canopen::Clock::now();
  if (result.has_error()) {
    if (!left_unchanged(result.error())) {
      commanded_.doubt(step.fields, since, now);
      node_.repetition_changed();
    }
    return;
  }
  commanded_.confirm(step.fields, step.rpdo, since, running().has_value(), now);
  node_.repetition_changed();
  for (const Field& field : step.fields) {
    note_confirmed(command, field, step.rpdo);
  }
  listener_.on_commanded(signals_of(step.fields));
}

void Commands::note_confirmed(PendingCommand& command, const Field& field, std::uint16_t rpdo) {
  const auto record = std::find_if(command.record.fields.begin(), command.record.fields.end(),
                                   [&](const FieldRecord& each) { return each.signal == field.signal; });
  if (record != command.record.fields.end()) {
    record->confirmed = field.raw;
  }
  if (commanded_.is_control(field.signal)) {
    const ControlUse use = use_of_control(field.raw);
    if (use == ControlUse::momentary && rpdo == 0 && commanded_.is_supervised(field.signal)) {
      command.note = "by SDO, so no RPDO is repeated: the drive's supervision of it may trip";
    }
    control_.on_confirmed_control(command.record.writer, use, canopen::Clock::now());
    control_changed();
  }
}

void Commands::take_out(PendingCommand& command, std::vector<Field>& fields, std::span<const Field> written) {
  for (const Field& field : written) {
    command.written += 1;
    command.written_names += (command.written_names.empty() ? "" : ", ") + model_.signals[field.signal].name;
    std::erase_if(fields, [&](const Field& other) { return other.signal == field.signal; });
  }
}

/// Where an object can be commanded by its RPDO only, the abort alone would not tell what to do.
Error Commands::explain(Error error, SignalId signal) const {
  const std::uint16_t rpdo = commanded_.rpdo_of(signal);
  if (rpdo == 0 || !takes_no_sdo(error)) {
    return error;
  }
  error.kind = ErrorKind::incomplete;
  error.detail = incomplete(signal).detail;
  return error;
}

Error Commands::incomplete(SignalId signal) const {
  const std::uint16_t rpdo = commanded_.rpdo_of(signal);
  Error told = error(ErrorKind::incomplete, "RPDO" + std::to_string(rpdo) +
                                                " is not complete, and the drive takes no single write of this "
                                                "object; " +
                                                completion_text(model_, rpdo));
  told.object = model_.signals[signal].object;
  return told;
}

awaitable<void> Commands::note_begin(PendingCommand& command) {
  command.noted = true;
  if (journal_ != nullptr) {
    co_await journal_->begun(command.record);
  }
}

void Commands::call_back() {
  PendingCommand* command = lane_.under_way();
  if (command == nullptr) {
    return;
  }
  // Where its step has not left, it is looked at again once the stop is through.
  command->withdrawn = true;
  if (command->carries_control || command->record.kind == CommandRecord::Kind::raw) {
    node_.withdraw_command();
  }
}

bool Commands::holds_all(std::span<const Field> fields) const {
  return std::all_of(fields.begin(), fields.end(),
                     [this](const Field& field) { return commanded_.held(field.signal) == field.raw; });
}

void Commands::on_status(const canopen::NodeStatus& status) {
  const bool live = status.online && status.nmt_now() == canopen::NmtState::operational;
  if (std::exchange(live_, live) && !live) {
    commanded_.on_session_end(status.lost ? "the drive was lost" : "the drive left operational or is not online");
    control_.on_session_end();
    on_void();
  }
  const bool doubled = status.doubled == canopen::Doubled::proof;
  if (std::exchange(doubled_, doubled) != doubled && doubled) {
    // It is there, and may run: whoever watches over its writer goes on, for stops still reach it.
    commanded_.on_session_end("two nodes have its node id");
    on_void();
  }
}

void Commands::on_boot_up() {
  commanded_.on_session_end("the drive rebooted");
  control_.on_session_end();
  on_void();
}

void Commands::on_fault_begin(std::string_view what) {
  commanded_.on_fault_begin(what);
  on_void();
}

void Commands::on_fault_end() {
  commanded_.on_fault_end();
  on_void();
}

void Commands::on_standstill(std::string_view what) {
  commanded_.on_standstill(what);
  on_void();
}

/// Something became void: what waits looks at itself again, and nothing of before is sent or repeated.
void Commands::on_void() {
  PendingCommand* command = lane_.under_way();
  if (command != nullptr && command->carries_control) {
    command->withdrawn = true;
    node_.withdraw_command();
  }
  node_.repetition_changed();
  changed_.notify();
  control_changed();
}

std::optional<bool> Commands::running() const {
  const auto& running = model_.faults.running;
  if (!running || !image_.fresh(static_cast<SignalId>(*running), canopen::Clock::now())) {
    return std::nullopt;
  }
  return image_.raw(static_cast<SignalId>(*running)) != 0;
}

std::optional<bool> Commands::running_since_commanded() const {
  const std::optional<bool> runs = running();
  const std::optional<SignalId> control = commanded_.control();
  if (runs != false || !control) {
    return runs;
  }
  const canopen::TimePoint seen = image_.source_of(static_cast<SignalId>(*model_.faults.running))->at;
  const std::optional<canopen::TimePoint> confirmed = commanded_.last_confirmed_at(*control);
  const bool newer = (confirmed && *confirmed >= seen) || commanded_.doubtful_at(*control) >= seen;
  return newer && use_of_control(commanded_.shown(*control)) == ControlUse::run ? std::nullopt : runs;
}

}  // namespace process
