// Arrival of a command, its checks and its place in the order.

#include "bridges/process/commands.h"

#include <algorithm>
#include <chrono>
#include <random>
#include <utility>

#include "bridges/process/command_checks.h"
#include "canopen/hex.h"
#include "canopen/node/remote_node.h"
#include "config/value_check.h"

namespace process {
namespace {

using boost::asio::awaitable;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Raw;
using canopen::Result;

std::string milliseconds(canopen::Duration time) {
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(time).count()) + " ms";
}

bool writes_all_of(const CommandRecord& later, const CommandRecord& earlier) {
  return std::all_of(earlier.fields.begin(), earlier.fields.end(), [&](const FieldRecord& field) {
    return std::any_of(later.fields.begin(), later.fields.end(),
                       [&](const FieldRecord& other) { return other.signal == field.signal; });
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
      id_prefix_(canopen::hex(std::random_device{}(), 8)) {
  if (const auto signal = model.find("control_command")) {
    control_signal_ = static_cast<SignalId>(*signal);
  }
}

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
    outcome = resolved.error();
  } else if (command.use == ControlUse::stop) {
    outcome = co_await overtake(command, resolved.value());
  } else {
    outcome = co_await write_in_turn(command, std::move(fields));
  }
  finish(command, outcome);
  co_return outcome;
}

awaitable<Outcome> Commands::stop_motor(Origin origin) {
  const std::optional<Raw> stop = canopen::first_stop(model_.node.motor);
  if (!stop || !control_signal_) {
    // It was asked for all the same: log and journal name the drive.
    const Visit visit(*this);
    PendingCommand command = arrive(std::move(origin), CommandRecord::Kind::write);
    Outcome unknown = error(ErrorKind::unknown, "no value of control_command is known to stop it");
    finish(command, unknown);
    co_return unknown;
  }
  std::vector<FieldWrite> fields{{*control_signal_, *stop}};
  Outcome outcome = co_await write(std::move(origin), std::move(fields));
  co_return outcome;
}

awaitable<Outcome> Commands::write_in_turn(PendingCommand& command, std::vector<FieldWrite> given) {
  if (const auto held = control_.refuse(command.record.writer, command.use, canopen::Clock::now())) {
    co_return error(ErrorKind::lease, *held);
  }
  const Result<std::vector<Field>> checked = resolve_and_check(given);
  if (checked.has_error()) {
    co_return checked.error();
  }
  if (std::optional<Error> refused = refuse_unreachable()) {
    co_return *std::move(refused);
  }
  accept(command);
  const CommandLane::Place place(lane_, command);
  std::optional<Error> refused = co_await await_turn(command);
  if (refused) {
    co_return *std::move(refused);
  }
  // Bits are changed of the word that stands now.
  const Result<std::vector<Field>> fields = resolve_and_check(given);
  if (fields.has_error()) {
    co_return fields.error();
  }
  std::vector<Field> ordered = in_writing_order(model_, fields.value());
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
  if (std::optional<Error> refused = refuse_asker(command)) {
    co_return *std::move(refused);
  }
  if (const auto held = control_.refuse(command.record.writer, command.use, canopen::Clock::now())) {
    co_return error(ErrorKind::lease, *held);
  }
  if (Refusal refused = refuse_out_of_service()) {
    co_return *std::move(refused);
  }
  if (node_.status().boot_result != canopen::BootResult::left_alone) {
    if (std::optional<Error> refused = refuse_nmt(nmt, running())) {
      co_return *std::move(refused);
    }
  }
  accept(command);
  const CommandLane::Place place(lane_, command);
  std::optional<Error> refused = co_await await_turn(command);
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

awaitable<Result<Raw>> Commands::sdo_read(canopen::ObjectAddress object, canopen::DataType type) {
  if (closed_) {
    co_return closed_error();
  }
  if (Refusal refused = refuse_out_of_service()) {
    co_return *std::move(refused);
  }
  const Visit visit(*this);
  Result<Raw> answer = co_await node_.read(object, type);
  co_return answer;
}

awaitable<Outcome> Commands::sdo_write(Origin origin, canopen::ObjectValue value) {
  if (const std::optional<SignalId> signal = writable_signal(model_, value.object)) {
    const canopen::DataType type = model_.signals[*signal].type;
    if (type != value.type && !refuse_writer(model_, origin.writer)) {
      Error wrong = error(ErrorKind::type, model_.signals[*signal].name + " is " + std::string(name_of(type)));
      wrong.object = value.object;
      co_return wrong;
    }
    std::vector<FieldWrite> fields{{*signal, canopen::normalise(type, value.raw)}};
    Outcome outcome = co_await write(std::move(origin), std::move(fields));
    co_return outcome;
  }
  const Visit visit(*this);
  PendingCommand command = arrive(std::move(origin), CommandRecord::Kind::raw);
  command.record.object = value;
  Outcome outcome = co_await send_raw(command, value);
  if (outcome.has_error()) {
    outcome.failure->object = value.object;
  }
  finish(command, outcome);
  co_return outcome;
}

awaitable<Outcome> Commands::send_raw(PendingCommand& command, canopen::ObjectValue value) {
  std::optional<Error> refused = refuse_asker(command);
  if (!refused) {
    if (const auto held = control_.refuse(command.record.writer, command.use, canopen::Clock::now())) {
      refused = error(ErrorKind::lease, *held);
    }
  }
  refused = refused ? refused : refuse_raw(model_, value.object);
  refused = refused ? refused : refuse_unreachable();
  if (refused) {
    co_return *std::move(refused);
  }
  accept(command);
  const CommandLane::Place place(lane_, command);
  refused = co_await await_turn(command);
  if (refused) {
    co_return *std::move(refused);
  }
  const Result<void> written = co_await node_.write(value.object, value.type, value.raw, command.deadline);
  if (written.has_error() && written.error().not_sent) {
    refused = refuse_waiting(command);
    co_return refused ? Outcome(*std::move(refused)) : Outcome(written);
  }
  co_return written;
}

PendingCommand Commands::arrive(Origin origin, CommandRecord::Kind kind) {
  PendingCommand command;
  command.record.kind = kind;
  command.record.id = origin.id;
  command.record.writer = std::move(origin.writer);
  command.record.drive = &model_;
  command.record.arrived = origin.received;
  command.record.wall = canopen::wall_now();
  command.number = ++arrivals_;
  if (command.record.id.empty()) {
    command.record.id = id_prefix_ + "-" + std::to_string(command.number);
  }
  command.deadline = origin.received + model_.commands.deadline;
  command.expires = origin.expires;
  command.epoch = commanded_.epoch();
  return command;
}

void Commands::take_fields(PendingCommand& command, std::span<const FieldWrite> fields) const {
  command.use = use_of(fields);
  command.record.writes_control = command.use != ControlUse::none;
  command.set_points_only = command.use == ControlUse::none;
  for (const FieldWrite& field : fields) {
    if (field.signal >= model_.signals.size()) {
      continue;
    }
    const config::Signal& signal = model_.signals[field.signal];
    FieldRecord record{.signal = field.signal};
    const Result<Raw> asked = check_given(commanded_.is_control(field.signal) ? without_limits(signal) : signal, field);
    if (asked.has_value()) {
      record.asked = asked.value();
      command.set_points_only = command.set_points_only && !config::is_momentary(signal, asked.value());
    }
    if (image_.fresh(field.signal, canopen::Clock::now())) {
      record.before = image_.raw(field.signal);
    } else if (image_.source_of(field.signal) == nullptr) {
      record.before = commanded_.held(field.signal);
    }
    command.record.fields.push_back(record);
  }
}

ControlUse Commands::use_of(std::span<const FieldWrite> fields) const {
  const auto control = std::find_if(fields.rbegin(), fields.rend(),
                                    [this](const FieldWrite& field) { return commanded_.is_control(field.signal); });
  if (control == fields.rend()) {
    return ControlUse::none;
  }
  // Limits of the site do not make a stop less of a stop.
  const config::Signal& signal = model_.signals[control->signal];
  const Result<Raw> raw = check_given(without_limits(signal), *control);
  if (raw.has_error()) {
    return ControlUse::run;
  }
  if (commanded_.is_stop(raw.value())) {
    return ControlUse::stop;
  }
  return config::is_momentary(signal, raw.value()) ? ControlUse::momentary : ControlUse::run;
}

bool Commands::is_stop(std::span<const FieldWrite> fields) const {
  const Result<std::vector<FieldWrite>> resolved = resolve(fields);
  return resolved.has_value() && use_of(resolved.value()) == ControlUse::stop;
}

Result<std::vector<FieldWrite>> Commands::resolve(std::span<const FieldWrite> fields) const {
  std::vector<FieldWrite> resolved(fields.begin(), fields.end());
  for (FieldWrite& field : resolved) {
    const Mask* mask = std::get_if<Mask>(&field.value);
    if (mask == nullptr || field.signal >= model_.signals.size()) {
      continue;
    }
    const Result<Raw> base = mask->and_mask == 0 ? Result<Raw>(Raw{0}) : base_of_bits(field.signal);
    if (base.has_error()) {
      return base.error();
    }
    const std::uint16_t word = mask->applied_to(static_cast<std::uint16_t>(base.value() & 0xFFFFU));
    field.value = canopen::normalise(model_.signals[field.signal].type, word);
  }
  return resolved;
}

Result<std::vector<Field>> Commands::resolve_and_check(std::span<const FieldWrite> fields) const {
  const Result<std::vector<FieldWrite>> resolved = resolve(fields);
  return resolved.has_value() ? check_fields(model_, resolved.value()) : Result<std::vector<Field>>(resolved.error());
}

Result<Raw> Commands::base_of_bits(SignalId signal) const {
  const SourceState* source = image_.source_of(signal);
  const auto confirmed = commanded_.confirmed_at(signal);
  const auto doubtful = commanded_.doubtful_at(signal);
  if (confirmed && (source == nullptr || !source->received || *confirmed >= source->at)) {
    return commanded_.known(signal).value_or(0);
  }
  if (source == nullptr) {
    return error(ErrorKind::incomplete, "nobody commanded the bits that are to be kept");
  }
  // What was read before the last command of it may be what that command took away.
  const auto last = commanded_.last_confirmed_at(signal);
  const bool older = (doubtful && source->at <= *doubtful) || (last && source->at <= *last);
  if (image_.fresh(signal, canopen::Clock::now()) && !older) {
    return image_.raw(signal);
  }
  return error(ErrorKind::offline, "the bits that are to be kept are not known: the value is not fresh");
}

Commands::Refusal Commands::refuse_asker(const PendingCommand& command) const {
  if (closed_) {
    return closed_error();
  }
  if (std::optional<Error> refused = refuse_writer(model_, command.record.writer)) {
    return refused;
  }
  if (canopen::Clock::now() >= command.expires) {
    return error(ErrorKind::expired, "the command came after its message expiry interval");
  }
  return std::nullopt;
}

Commands::Refusal Commands::refuse_out_of_service() const {
  return model_.enabled ? std::nullopt : Refusal(error(ErrorKind::offline, "the drive is out of service"));
}

Commands::Refusal Commands::refuse_unreachable() const {
  if (Refusal refused = refuse_out_of_service()) {
    return refused;
  }
  const canopen::NodeStatus& status = node_.status();
  if (!status.online || !status.configured) {
    return error(ErrorKind::offline,
                 status.nmt == canopen::NmtState::unknown ? "the drive is offline" : "the drive is not booted");
  }
  if (status.nmt != canopen::NmtState::operational) {
    return error(ErrorKind::offline, "the drive is " + std::string(name_of(status.nmt)) + ", not operational");
  }
  return std::nullopt;
}

/// What a command was given for may be over while it waits.
Commands::Refusal Commands::refuse_waiting(const PendingCommand& command) const {
  if (closed_) {
    return closed_error();
  }
  if (command.ended) {
    return command.ended;
  }
  const bool may_move = command.use != ControlUse::none || command.record.kind == CommandRecord::Kind::raw;
  if (may_move && command.number < last_stop_) {
    return error(ErrorKind::superseded, "a stop came after it: " + last_stop_text_);
  }
  const std::string_view over = commanded_.control_void_since(command.epoch);
  if (command.use != ControlUse::none && !over.empty()) {
    return error(ErrorKind::voided, "given before and not sent: " + std::string(over));
  }
  const std::string_view gone = commanded_.all_void_since(command.epoch);
  if (command.record.kind != CommandRecord::Kind::nmt && !gone.empty()) {
    return error(ErrorKind::offline, "not sent: meanwhile " + std::string(gone));
  }
  if (!command.begun && canopen::Clock::now() >= command.expires) {
    return error(ErrorKind::expired, "its message expiry interval passed while it waited");
  }
  return std::nullopt;
}

Commands::Refusal Commands::refuse_for_time(const PendingCommand& command) const {
  const canopen::TimePoint now = canopen::Clock::now();
  const canopen::Duration needed = std::min(node_.write_time(), model_.commands.deadline / 2);
  const canopen::Duration left = command.deadline - now;
  if (left >= needed && left > canopen::Duration::zero()) {
    return std::nullopt;
  }
  std::string text = "not begun after " + milliseconds(now - command.record.arrived) + " and withdrawn";
  if (left > canopen::Duration::zero()) {
    text += ": " + milliseconds(left) + " are left, a write of this drive takes up to " + milliseconds(needed);
  }
  Error late = error(ErrorKind::timeout, std::move(text));
  late.not_sent = true;
  return late;
}

void Commands::accept(const PendingCommand& command) {
  control_.on_accepted(command.record.writer, command.use, canopen::Clock::now());
  control_changed();
  if (command.record.kind == CommandRecord::Kind::write && !command.relies_on_bits) {
    supersede_older(command);
  }
}

/// Newest wins: what waits, sets set-points only and is written whole by this one is not worth its time any more.
void Commands::supersede_older(const PendingCommand& by) {
  for (PendingCommand* older : lane_.all()) {
    const bool waits = older->set_points_only && !older->begun && !older->ended &&
                       older->record.kind == CommandRecord::Kind::write && older->number < by.number;
    if (waits && older->record.writer == by.record.writer && writes_all_of(by.record, older->record)) {
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

Commands::Refusal Commands::refuse_nmt(canopen::NmtCommand command, std::optional<bool> running) const {
  if (command == canopen::NmtCommand::start || model_.commands.nmt_while_running || running == false) {
    return std::nullopt;
  }
  return error(ErrorKind::forbidden,
               std::string(running ? "the motor runs" : "nobody can tell whether the motor runs") +
                   "; nmt_while_running would allow it");
}

awaitable<Commands::Refusal> Commands::refuse_nmt_now(canopen::NmtCommand command) {
  std::optional<bool> runs = running();
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
    if (command.record.kind == CommandRecord::Kind::write) {
      last_written_ = command.written;
    }
  } else if (outcome.note.empty()) {
    outcome.note = command.note;
  }
  if (journal_ != nullptr) {
    journal_->done(command.record, outcome);
  }
  listener_.on_command_done(command.record, outcome);
}

void Commands::on_status(const canopen::NodeStatus& status) {
  const bool live = status.online && status.nmt == canopen::NmtState::operational;
  if (std::exchange(live_, live) && !live) {
    commanded_.on_session_end(status.lost ? "the drive was lost" : "the drive left operational or is not online");
    control_.on_session_end();
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
