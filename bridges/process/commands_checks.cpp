// What is said of a command at its arrival and while it waits.

#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "bridges/process/command_checks.h"
#include "bridges/process/commands.h"
#include "bridges/process/stop_check.h"
#include "canopen/node/remote_node.h"

namespace process {
namespace {

using canopen::Error;
using canopen::ErrorKind;
using canopen::Raw;
using canopen::Result;

std::string milliseconds(canopen::Duration time) {
  return std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(time).count()) + " ms";
}

}  // namespace

PendingCommand Commands::arrive(Origin origin, CommandRecord::Kind kind) {
  PendingCommand command;
  command.record.kind = kind;
  command.record.id = origin.id;
  command.record.writer = std::move(origin.writer);
  command.record.drive = &model_;
  command.record.arrived = origin.received;
  command.record.wall = canopen::wall_now();
  command.arrived_until = std::max(origin.received, origin.received_until);
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
    const Result<Raw> asked = check_given(without_limits(signal), field);
    if (const double* const number = asked.has_value() ? nullptr : std::get_if<double>(&field.value)) {
      record.given = *number;
    }
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
  const Result<Raw> raw = check_given(without_limits(model_.signals[control->signal]), *control);
  return raw.has_error() ? ControlUse::run : use_of_control(raw.value());
}

ControlUse Commands::use_of_control(Raw word) const {
  if (commanded_.is_stop(word)) {
    return ControlUse::stop;
  }
  return config::is_momentary(model_.signals[*commanded_.control()], word) ? ControlUse::momentary : ControlUse::run;
}

bool Commands::is_stop(std::span<const FieldWrite> fields) const {
  const Result<std::vector<FieldWrite>> resolved = resolve(fields);
  return resolved.has_value() && process::is_stop(model_, resolved.value());
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

Outcome Commands::refuse(Origin origin, CommandRecord::Kind kind, Error mistake) {
  const PendingCommand command = arrive(std::move(origin), kind);
  Refusal before;
  if (mistake.kind != ErrorKind::retained) {
    before = refuse_writer(model_, command.record.writer);
  }
  const bool after_lease =
      mistake.kind == ErrorKind::read_only || mistake.kind == ErrorKind::type || mistake.kind == ErrorKind::range;
  if (!before && after_lease) {
    before = refuse_lease(command);
  }
  Outcome outcome = before ? *std::move(before) : std::move(mistake);
  finish(command, outcome);
  return outcome;
}

Outcome Commands::refuse_type(Origin origin, const canopen::ObjectValue& value, std::vector<std::uint8_t> bytes,
                              SignalId signal) {
  PendingCommand command = arrive(std::move(origin), CommandRecord::Kind::raw);
  command.record.object = value;
  command.record.bytes = std::move(bytes);
  std::optional<Error> refused = refuse_asker(command);
  if (!refused) {
    const config::Signal& what = model_.signals[signal];
    refused = error(ErrorKind::type, what.name + " is " + std::string(name_of(what.type)));
  }
  refused->object = value.object;
  Outcome outcome = *std::move(refused);
  finish(command, outcome);
  return outcome;
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

Commands::Refusal Commands::refuse_lease(const PendingCommand& command) const {
  const auto held = control_.refuse(command.record.writer, command.use, canopen::Clock::now());
  return held ? Refusal(error(ErrorKind::lease, *held)) : std::nullopt;
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
  if (status.nmt_now() != canopen::NmtState::operational) {
    return error(ErrorKind::offline, "the drive is " + std::string(name_of(status.nmt_now())) + ", not operational");
  }
  if (status.doubled == canopen::Doubled::proof) {
    return error(ErrorKind::offline, "two nodes have its node id, no commands but stops: " + status.doubled_text);
  }
  return std::nullopt;
}

/// It may have come here late: a bridge that carries out the requests of a connection one by one takes it up when those
/// before it are answered, and by then a stop of another way is long confirmed.
Commands::Refusal Commands::refuse_older_than_stop(const PendingCommand& command) const {
  const bool may_move = command.use != ControlUse::none || command.record.kind == CommandRecord::Kind::raw;
  if (may_move && (command.number < last_stop_ || command.record.arrived < last_stop_arrived_)) {
    return error(ErrorKind::superseded, "a stop came after it: " + last_stop_text_);
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
  if (Refusal refused = refuse_older_than_stop(command)) {
    return refused;
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

Commands::Refusal Commands::refuse_nmt(canopen::NmtCommand command, std::optional<bool> running) const {
  const bool starts_or_stops = command == canopen::NmtCommand::start || command == canopen::NmtCommand::stop;
  if (node_.status().doubled == canopen::Doubled::proof && !starts_or_stops) {
    return error(ErrorKind::offline, "two nodes have its node id: NMT start and stop only");
  }
  if (command == canopen::NmtCommand::start || model_.commands.nmt_while_running || running == false) {
    return std::nullopt;
  }
  return error(ErrorKind::forbidden,
               std::string(running ? "the motor runs" : "nobody can tell whether the motor runs") +
                   "; nmt_while_running would allow it");
}

}  // namespace process
