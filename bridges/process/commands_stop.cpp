// Stops: they go before everything that waits.

#include <algorithm>
#include <string>
#include <utility>

#include "bridges/process/command_checks.h"
#include "bridges/process/commands.h"
#include "canopen/node/remote_node.h"

namespace process {

using boost::asio::awaitable;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

Commands::StopParts Commands::take_apart(const PendingCommand& command, std::span<const FieldWrite> given) const {
  StopParts parts;
  const auto lease = command.passes_lease
                         ? std::nullopt
                         : control_.refuse(command.record.writer, ControlUse::none, canopen::Clock::now());
  for (const FieldWrite& write : given) {
    const bool control = commanded_.is_control(write.signal);
    if (control) {
      if (const Result<canopen::Raw> raw = check_given(without_limits(model_.signals[write.signal]), write);
          raw.has_value()) {
        parts.fields.push_back({write.signal, raw.value()});
      }
      continue;
    }
    const Result<std::vector<Field>> checked = check_fields(model_, {write});
    if (lease || checked.has_error()) {
      Error why = lease ? error(ErrorKind::lease, *lease) : checked.error();
      if (!lease && write.signal < model_.signals.size()) {
        why.detail = model_.signals[write.signal].name + ": " + why.detail;
      }
      // The first one's kind; each is named.
      if (!parts.left_out) {
        parts.left_out = std::move(why);
      } else if (!lease) {
        parts.left_out->detail += "; " + why.detail;
      }
    } else {
      parts.fields.push_back(checked.value().front());
    }
  }
  parts.fields = in_writing_order(commanded_, std::move(parts.fields));
  if (!parts.fields.empty() && commanded_.is_control(parts.fields.back().signal)) {
    std::rotate(parts.fields.begin(), parts.fields.end() - 1, parts.fields.end());
  }
  return parts;
}

awaitable<Outcome> Commands::overtake(PendingCommand& command, std::vector<FieldWrite> given) {
  if (Refusal refused = refuse_out_of_service()) {
    co_return *std::move(refused);
  }
  StopParts parts = take_apart(command, given);
  command.deadline = canopen::Clock::now() + model_.commands.deadline;
  if (!command.passes_lease) {
    control_.on_accepted(command.record.writer, command.use, canopen::Clock::now());
    control_changed();
  }
  const bool unchanged = holds_all(parts.fields) && !parts.left_out;
  supersede_older(command, parts.fields);
  go_first(command, parts.fields.front().raw);
  Result<void> stopped = co_await send_stop(command, parts.fields);
  stopped = co_await join_equal(command, parts.fields, std::move(stopped));
  if (stopped.has_error()) {
    co_return stopped;
  }
  Outcome rest = co_await write_first(command, std::move(parts.fields));
  if (rest.has_value() && parts.left_out) {
    rest = with_written(*std::move(parts.left_out), command.written_names);
  }
  rest.unchanged = unchanged && rest.has_value();
  co_return rest;
}

awaitable<Outcome> Commands::write_first(PendingCommand& command, std::vector<Field> fields) {
  if (fields.empty()) {
    co_return Outcome();
  }
  command.use = ControlUse::none;  // From here on it is no stop: the next one does not wait for it.
  command.begun = false;
  const CommandLane::Place place(lane_, command, true);
  Refusal refused = co_await await_turn(command);
  if (refused) {
    co_return with_written(*std::move(refused), command.written_names);
  }
  Outcome outcome = co_await carry_out(command, std::move(fields));
  co_return outcome;
}

bool Commands::asks_control(const PendingCommand& command, canopen::Raw raw) const {
  const std::vector<FieldRecord>& fields = command.record.fields;
  return std::any_of(fields.begin(), fields.end(), [&](const FieldRecord& field) {
    return commanded_.is_control(field.signal) && field.asked == raw;
  });
}

/// From its arrival on, nothing older that writes `control_command` leaves any more, and what is repeated holds the
/// stop.
void Commands::go_first(const PendingCommand& stop, canopen::Raw raw) {
  last_stop_ = stop.number;
  last_stop_arrived_ = std::max(last_stop_arrived_, stop.arrived_until);
  last_stop_text_ = "control_command " + std::to_string(raw) + " of " + to_string(stop.record.writer);
  for (PendingCommand* older : stops_.all()) {
    const bool equal = asks_control(*older, raw);
    // One that waits for its turn is done by the newer one; one under way is not waited for any longer. An equal one
    // that is being completed goes on: all that it reads the newer one would have to read, too.
    if (!older->begun && !older->left && equal && older->record.fields.size() == 1) {
      older->ended = error(ErrorKind::superseded, "an equal stop came after it: " + last_stop_text_);
    } else if (older->begun) {
      hurry(*older, stop, equal);
    }
  }
  commanded_.on_stop(raw);
  call_back();
  node_.repetition_changed();
  changed_.notify();
}

void Commands::hurry(PendingCommand& older, const PendingCommand& newer, bool equal) {
  node_.hurry_stop(older.stop_limit, newer.deadline);
  if (!equal) {
    node_.hurry_stop(older.read_limit, newer.deadline);
  }
}

awaitable<Commands::Refusal> Commands::await_stop_turn(PendingCommand& command) {
  while (!stops_.is_first(command)) {
    if (closed_) {
      co_return closed_error();
    }
    if (command.ended) {
      co_return command.ended;
    }
    if (canopen::Clock::now() >= command.deadline) {
      co_return refuse_for_time(command);
    }
    co_await changed_.wait_until(command.deadline);
  }
  if (closed_) {
    co_return closed_error();
  }
  command.begun = true;
  co_return std::nullopt;
}

awaitable<Result<void>> Commands::send_stop(PendingCommand& command, std::vector<Field>& fields) {
  const CommandLane::Place place(stops_, command);
  const Field control = fields.front();
  co_await note_begin(command);
  if (closed_) {
    co_return closed_error();
  }
  const canopen::ObjectAddress object = model_.signals[control.signal].object;
  const std::uint16_t rpdo = commanded_.rpdo_of(control.signal);
  const WriteStep step{rpdo, fields_of(commanded_, rpdo, fields)};
  bool left_by_rpdo = false;
  // Where it is not served its RPDOs are not sure.
  if (rpdo != 0 && !refuse_unreachable() && commanded_.values(rpdo, step.fields)) {
    const bool doubtful = node_.may_still_act(object);
    const Result<void> left = co_await send_rpdo(command, step, {});
    left_by_rpdo = left.has_value();
    note_left(command, left);
    // An older write of the same object that the drive has not answered, and an older stop that is not through, may
    // still take effect: it is written again behind them.
    // One that is taken by RPDO alone has nothing under way by SDO, and an older stop gives way to this one, which is
    // on the bus, even where this one is through by then.
    const bool sure = !doubtful && !node_.may_still_act(object) && stops_.is_first(command);
    if (left_by_rpdo && (sure || model_.signals[control.signal].pdo_only)) {
      take_out(command, fields, step.fields);
      co_return left;
    }
  }
  Refusal refused = co_await await_stop_turn(command);
  Result<void> written;
  if (refused) {
    written = *std::move(refused);
  } else {
    written = co_await stop_by_sdo(command, fields, left_by_rpdo);
  }
  if (written.has_error() && command.left) {
    Error told = written.error();
    told.not_sent = false;
    told.outcome_unknown = told.kind != ErrorKind::refused;
    told.detail = "sent by RPDO; then by SDO: " + told.detail;
    co_return told;
  }
  co_return written;
}

awaitable<Result<void>> Commands::stop_by_sdo(PendingCommand& command, std::vector<Field>& fields, bool left_by_rpdo) {
  const Field control = fields.front();
  for (const PendingCommand* other : stops_.all()) {
    if (other->number > command.number) {
      hurry(command, *other, asks_control(*other, control.raw));
    }
  }
  const bool pdo_only = model_.signals[control.signal].pdo_only && !refuse_unreachable();
  if (pdo_only) {
    const Result<void> left = co_await complete_by_reading(command, fields);
    // Nothing is left untried where it cannot be completed: whoever says so of the drive may be wrong.
    if (!left.has_error() || left.error().kind != ErrorKind::incomplete) {
      co_return left;
    }
    if (Refusal refused = refuse_superfluous(command)) {
      co_return *std::move(refused);
    }
  }
  const Result<void> written = co_await send_sdo(command, control, true);
  if (written.has_value()) {
    take_out(command, fields, {{control}});
  }
  if (written.has_value() || written.error().kind != ErrorKind::refused || refuse_unreachable()) {
    co_return written;
  }
  if (left_by_rpdo && takes_no_sdo(written.error())) {
    // Then it took no older write of it either.
    const std::vector<Field> sent = fields_of(commanded_, commanded_.rpdo_of(control.signal), fields);
    take_out(command, fields, sent);
    co_return Result<void>();
  }
  if (pdo_only) {
    co_return explain(written.error(), control.signal);
  }
  const Result<void> left = co_await complete_by_reading(command, fields);
  const bool never_sent = left.has_error() && left.error().kind == ErrorKind::incomplete;
  co_return never_sent ? Result<void>(explain(written.error(), control.signal)) : left;
}

/// Only a newer stop that is on the bus stops the motor in its place: where stops keep coming, each would else give way
/// to the next one, and none would leave.
Commands::Refusal Commands::refuse_superfluous(const PendingCommand& stop) const {
  return last_left_stop_ > stop.number ? Refusal(error(ErrorKind::superseded, "a newer stop came: " + last_stop_text_))
                                       : std::nullopt;
}

void Commands::note_left(PendingCommand& stop, const Result<void>& sent) {
  stop.left = !sent.has_error() || !sent.error().not_sent;
  if (stop.left) {
    last_left_stop_ = std::max(last_left_stop_, stop.number);
  }
}

awaitable<Result<void>> Commands::join_equal(PendingCommand& command, std::vector<Field>& fields,
                                             Result<void> stopped) {
  if (!stopped.has_error() || !stopped.error().outcome_unknown || fields.size() != 1) {
    co_return stopped;
  }
  const Field control = fields.front();
  const canopen::TimePoint since = canopen::Clock::now();
  const auto equal_waits = [&] {
    return std::any_of(stops_.all().begin(), stops_.all().end(), [&](const PendingCommand* other) {
      return other->number > command.number && asks_control(*other, control.raw);
    });
  };
  const auto confirmed = [&] {
    const auto at = commanded_.last_confirmed_at(control.signal);
    return at && *at >= since && commanded_.shown(control.signal) == control.raw;
  };
  while (!confirmed() && equal_waits() && !closed_ && canopen::Clock::now() < command.deadline) {
    co_await changed_.wait_until(command.deadline);
  }
  if (!confirmed()) {
    co_return stopped;
  }
  note_confirmed(command, control, 0);
  take_out(command, fields, {{control}});
  co_return Result<void>();
}

/// A drive that takes its control command only by PDO: what it holds of the set-points completes a stop, and a stop
/// alone.
awaitable<Result<void>> Commands::complete_by_reading(PendingCommand& command, std::vector<Field>& fields) {
  const SignalId control = fields.front().signal;
  const std::uint16_t rpdo = commanded_.rpdo_of(control);
  const WriteStep step{rpdo, fields_of(commanded_, rpdo, fields)};
  const auto missing = commanded_.missing(rpdo, step.fields);
  const Error incomplete{.kind = ErrorKind::incomplete};
  if (!missing) {
    co_return incomplete;
  }
  if (Refusal refused = refuse_superfluous(command)) {
    co_return *std::move(refused);
  }
  std::vector<Field> borrowed;
  for (const SignalId signal : *missing) {
    const config::Signal& what = model_.signals[signal];
    const Result<canopen::Raw> held =
        co_await node_.read_for_stop(what.object, what.type, command.deadline, command.read_limit);
    if (Refusal refused = refuse_superfluous(command)) {
      co_return *std::move(refused);
    }
    if (held.has_error() || closed_) {
      co_return incomplete;
    }
    borrowed.push_back({signal, held.value()});
  }
  Result<void> left = co_await send_rpdo(command, step, borrowed);
  note_left(command, left);
  if (left.has_value()) {
    take_out(command, fields, step.fields);
  }
  co_return left;
}

}  // namespace process
