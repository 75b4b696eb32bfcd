// The ways in, the order of commands and their answers.

#include "bridges/process/commands.h"

#include <algorithm>
#include <random>
#include <utility>

#include "bridges/process/command_checks.h"
#include "canopen/hex.h"
#include "canopen/node/remote_node.h"

namespace process {
namespace {

using boost::asio::awaitable;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Raw;
using canopen::Result;

bool writes_all_of(std::span<const Field> later, const CommandRecord& earlier) {
  return std::all_of(earlier.fields.begin(), earlier.fields.end(), [&](const FieldRecord& field) {
    return std::any_of(later.begin(), later.end(), [&](const Field& other) { return other.signal == field.signal; });
  });
}

}  // namespace

Commands::Commands(boost::asio::any_io_executor executor, const config::Drive& model, canopen::RemoteNode& node,
                   const Image& image, Listener& listener)
    : executor_(std::move(executor)),
      model_(model),
      node_(node),
      image_(image),
      listener_(listener),
      commanded_(model),
      control_(control_settings(model.commands)),
      control_time_(executor_, [this] { on_control_time(); }),
      changed_(executor_),
      id_prefix_(canopen::hex(std::random_device{}(), 8)) {}

awaitable<Outcome> Commands::write(Origin origin, std::vector<FieldWrite> fields) {
  const Visit visit(*this);
  PendingCommand command = arrive(std::move(origin), CommandRecord::Kind::write);
  const Result<std::vector<FieldWrite>> resolved = resolve(fields);
  take_fields(command, resolved.has_value() ? resolved.value() : fields);
  command.relies_on_bits = std::any_of(
      fields.begin(), fields.end(), [](const FieldWrite& field) { return std::holds_alternative<Mask>(field.value); });
  Outcome outcome;
  if (std::optional<Error> refused = refuse_asker(command)) {
    outcome = *std::move(refused);
  } else if (resolved.has_error()) {
    outcome = refuse_lease(command).value_or(resolved.error());
  } else if (command.use == ControlUse::stop) {
    outcome = co_await overtake(command, resolved.value());
  } else {
    outcome = co_await write_in_turn(command, std::move(fields), resolved.value());
  }
  if (outcome.has_error()) {
    last_written_ = command.written;
  }
  finish(command, outcome);
  co_return outcome;
}

awaitable<Outcome> Commands::stop_motor(Origin origin) {
  const std::optional<Raw> stop = canopen::first_stop(model_.node.motor);
  if (!stop || !commanded_.control()) {
    // It was asked for all the same: log and journal name the drive.
    const Visit visit(*this);
    PendingCommand command = arrive(std::move(origin), CommandRecord::Kind::write);
    Outcome unknown = error(ErrorKind::unknown, "no value of control_command is known to stop it");
    finish(command, unknown);
    co_return unknown;
  }
  std::vector<FieldWrite> fields{{*commanded_.control(), *stop}};
  Outcome outcome = co_await write(std::move(origin), std::move(fields));
  co_return outcome;
}

awaitable<Outcome> Commands::write_in_turn(PendingCommand& command, std::vector<FieldWrite> given,
                                           const std::vector<FieldWrite>& resolved) {
  if (Refusal refused = refuse_lease(command)) {
    co_return *std::move(refused);
  }
  const Result<std::vector<Field>> checked = check_fields(model_, resolved);
  if (checked.has_error()) {
    co_return checked.error();
  }
  Refusal unfit = refuse_unreachable();
  unfit = unfit ? unfit : refuse_older_than_stop(command);
  if (unfit) {
    co_return *std::move(unfit);
  }
  accept(command);
  supersede_older(command, checked.value());
  const CommandLane::Place place(lane_, command);
  std::optional<Error> refused = co_await await_turn(command);
  if (refused) {
    co_return *std::move(refused);
  }
  // Bits are changed of the word that stands now.
  const Result<std::vector<FieldWrite>> now = resolve(given);
  if (now.has_error()) {
    co_return now.error();
  }
  const Result<std::vector<Field>> fields = check_fields(model_, now.value());
  if (fields.has_error()) {
    co_return fields.error();
  }
  std::vector<Field> ordered = in_writing_order(commanded_, fields.value());
  const bool unchanged = holds_all(ordered);
  Outcome outcome = co_await carry_out(command, std::move(ordered));
  outcome.unchanged = unchanged && outcome.has_value();
  co_return outcome;
}

awaitable<Outcome> Commands::nmt(Origin origin, canopen::NmtCommand nmt) {
  const Visit visit(*this);
  PendingCommand command = arrive(std::move(origin), CommandRecord::Kind::nmt);
  command.record.nmt = nmt;
  Outcome outcome = co_await send_nmt(command, nmt);
  finish(command, outcome);
  co_return outcome;
}

awaitable<Outcome> Commands::send_nmt(PendingCommand& command, canopen::NmtCommand nmt) {
  Refusal refused = refuse_asker(command);
  refused = refused ? refused : refuse_lease(command);
  refused = refused ? refused : refuse_out_of_service();
  if (!refused && node_.status().boot_result != canopen::BootResult::left_alone) {
    refused = refuse_nmt(nmt, running_since_commanded());
  }
  if (refused) {
    co_return *std::move(refused);
  }
  accept(command);
  const CommandLane::Place place(lane_, command);
  refused = co_await await_turn(command);
  if (refused) {
    co_return *std::move(refused);
  }
  // A run command may have been before it in the queue.
  refused = co_await refuse_nmt_now(nmt);
  if (refused) {
    co_return *std::move(refused);
  }
  const Result<void> left = co_await node_.command(nmt, command.deadline);
  co_return left;
}

void Commands::accept(const PendingCommand& command) {
  control_.on_accepted(command.record.writer, command.use, canopen::Clock::now());
  control_changed();
}

/// Newest wins: what waits, sets set-points only and is written whole by this one is not worth its time any more.
void Commands::supersede_older(const PendingCommand& by, std::span<const Field> fields) {
  if (by.relies_on_bits) {
    return;
  }
  for (PendingCommand* older : lane_.all()) {
    const bool waits = older->set_points_only && !older->begun && !older->ended &&
                       older->record.kind == CommandRecord::Kind::write && older->number < by.number;
    if (waits && older->record.writer == by.record.writer && writes_all_of(fields, older->record)) {
      older->ended = error(ErrorKind::superseded, "a later command of " + to_string(by.record.writer) + " came first");
    }
  }
  changed_.notify();
}

awaitable<Commands::Refusal> Commands::await_turn(PendingCommand& command) {
  while (true) {
    if (Refusal refused = refuse_waiting(command)) {
      co_return refused;
    }
    if (lane_.is_first(command) && stops_.empty()) {
      break;
    }
    if (canopen::Clock::now() >= command.deadline) {
      co_return refuse_for_time(command);
    }
    co_await changed_.wait_until(std::min(command.deadline, command.expires));
  }
  if (Refusal late = refuse_for_time(command)) {
    co_return late;
  }
  if (command.record.kind != CommandRecord::Kind::nmt) {
    if (Refusal refused = refuse_unreachable()) {
      co_return refused;
    }
  }
  command.begun = true;
  co_return std::nullopt;
}

awaitable<Commands::Refusal> Commands::refuse_nmt_now(canopen::NmtCommand command) {
  std::optional<bool> runs = running_since_commanded();
  const bool matters = command != canopen::NmtCommand::start && !model_.commands.nmt_while_running;
  if (!runs && matters && node_.status().boot_result == canopen::BootResult::left_alone) {
    runs = co_await node_.motor_runs();  // Nothing that it sends can be trusted, but it answers.
  }
  co_return closed_ ? Refusal(closed_error()) : refuse_nmt(command, runs);
}

void Commands::finish(const PendingCommand& command, Outcome& outcome) {
  outcome.id = command.record.id;
  outcome.written = command.written;
  if (outcome.has_error()) {
    const Error& failure = outcome.error();
    if (failure.kind == ErrorKind::refused) {
      last_refused_abort_ = failure.abort;
    } else if (failure.kind == ErrorKind::superseded || failure.kind == ErrorKind::voided) {
      last_refused_abort_ = 0;
    }
  } else if (outcome.note.empty()) {
    outcome.note = command.note;
  }
  if (journal_ != nullptr) {
    journal_->done(command.record, outcome);
  }
  listener_.on_command_done(command.record, outcome);
}

void Commands::close() {
  closed_ = true;
  control_time_.cancel();
  changed_.notify();
}

awaitable<void> Commands::until_idle() {
  while (visits_ > 0) {
    co_await changed_.wait_until(canopen::TimePoint::max());
  }
}

Error Commands::closed_error() const {
  return error(ErrorKind::offline, "the gateway does not serve this drive any more");
}

Error Commands::error(ErrorKind kind, std::string detail) const {
  return command_error(model_, kind, std::move(detail));
}

}  // namespace process
