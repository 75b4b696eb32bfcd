// The ways in, the order of commands and their answers.

#include "bridges/process/commands.h"

#include <algorithm>
#include <array>
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

// Nothing where no basic type has that many bytes.
std::optional<canopen::DataType> unsigned_type(std::size_t bytes) {
  switch (bytes) {
    case 1:
      return canopen::DataType::u8;
    case 2:
      return canopen::DataType::u16;
    case 4:
      return canopen::DataType::u32;
    case 8:
      return canopen::DataType::u64;
    default:
      return std::nullopt;
  }
}

// Nothing where the bytes are not those of a value of that type: too many, too few, or a boolean of more than 1.
std::optional<Raw> exact_raw(canopen::DataType type, std::span<const std::uint8_t> bytes) {
  const std::optional<Raw> raw = canopen::decode_raw(type, bytes);
  std::array<std::uint8_t, sizeof(Raw)> back{};
  const bool same = raw && std::ranges::equal(std::span(back).first(canopen::encode_raw(type, *raw, back)), bytes);
  return same ? raw : std::nullopt;
}

// Some drives answer in four bytes whatever the object's type is (Goodrive600): what is beyond the type then only
// fills.
bool only_extends(canopen::DataType type, Raw raw, std::span<const std::uint8_t> rest) {
  const bool negative = canopen::is_signed(type) && static_cast<std::int64_t>(raw) < 0;
  return std::ranges::all_of(rest, [&](std::uint8_t byte) { return byte == (negative ? 0xFFU : 0U); });
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
    outcome = resolved.error();
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

awaitable<Result<Raw>> Commands::sdo_read(canopen::ObjectAddress object, canopen::DataType type) {
  if (closed_) {
    co_return closed_error();
  }
  if (Refusal refused = refuse_out_of_service()) {
    co_return *std::move(refused);
  }
  const Visit visit(*this);
  const std::size_t length = canopen::byte_length(type);
  const Result<std::vector<std::uint8_t>> bytes = co_await node_.read_bytes(object, length);
  if (bytes.has_error()) {
    co_return bytes.error();
  }
  const std::optional<Raw> raw = canopen::decode_raw(type, bytes.value());
  if (raw && only_extends(type, *raw, std::span(bytes.value()).subspan(length))) {
    co_return *raw;
  }
  // A part of a value is another value.
  Error wrong = error(ErrorKind::type, "the drive answers " + std::to_string(bytes.value().size()) + " bytes, and " +
                                           std::string(canopen::name_of(type)) + " has " + std::to_string(length));
  wrong.object = object;
  co_return wrong;
}

awaitable<Outcome> Commands::sdo_write(Origin origin, canopen::ObjectValue value) {
  if (const std::optional<SignalId> signal = writable_signal(model_, value.object)) {
    const canopen::DataType type = model_.signals[*signal].type;
    if (type != value.type) {
      co_return refuse_type(std::move(origin), value, {}, *signal);
    }
    std::vector<FieldWrite> fields{{*signal, canopen::normalise(type, value.raw)}};
    Outcome outcome = co_await write(std::move(origin), std::move(fields));
    co_return outcome;
  }
  std::vector<std::uint8_t> none;
  Outcome outcome = co_await write_raw(std::move(origin), value, std::move(none));
  co_return outcome;
}

awaitable<Result<std::vector<std::uint8_t>>> Commands::sdo_read(canopen::ObjectAddress object) {
  if (closed_) {
    co_return closed_error();
  }
  if (Refusal refused = refuse_out_of_service()) {
    co_return *std::move(refused);
  }
  const Visit visit(*this);
  const auto signal = std::ranges::find(model_.signals, object, &config::Signal::object);
  const std::size_t expected = signal == model_.signals.end() ? 0 : canopen::byte_length(signal->type);
  Result<std::vector<std::uint8_t>> answer = co_await node_.read_bytes(object, expected);
  co_return answer;
}

awaitable<Outcome> Commands::sdo_write(Origin origin, canopen::ObjectAddress object, std::vector<std::uint8_t> data) {
  const std::optional<SignalId> signal = writable_signal(model_, object);
  const std::optional<canopen::DataType> type =
      signal ? std::optional(model_.signals[*signal].type) : unsigned_type(data.size());
  if (const std::optional<Raw> raw = type ? exact_raw(*type, data) : std::nullopt) {
    const canopen::ObjectValue value{.object = object, .type = *type, .raw = *raw};
    Outcome outcome = co_await sdo_write(std::move(origin), value);
    co_return outcome;
  }
  const canopen::ObjectValue named{.object = object};
  if (signal) {
    co_return refuse_type(std::move(origin), named, std::move(data), *signal);
  }
  Outcome outcome = co_await write_raw(std::move(origin), named, std::move(data));
  co_return outcome;
}

awaitable<Outcome> Commands::write_raw(Origin origin, canopen::ObjectValue value, std::vector<std::uint8_t> bytes) {
  const Visit visit(*this);
  PendingCommand command = arrive(std::move(origin), CommandRecord::Kind::raw);
  command.record.object = value;
  command.record.bytes = std::move(bytes);
  Outcome outcome = co_await send_raw(command);
  if (outcome.has_error()) {
    outcome.failure->object = value.object;
  }
  finish(command, outcome);
  co_return outcome;
}

awaitable<Outcome> Commands::send_raw(PendingCommand& command) {
  const canopen::ObjectValue value = *command.record.object;
  Refusal refused = refuse_asker(command);
  refused = refused ? refused : refuse_lease(command);
  refused = refused ? refused : refuse_raw(model_, value.object);
  refused = refused ? refused : refuse_unreachable();
  refused = refused ? refused : refuse_older_than_stop(command);
  if (refused) {
    co_return *std::move(refused);
  }
  accept(command);
  const CommandLane::Place place(lane_, command);
  refused = co_await await_turn(command);
  if (refused) {
    co_return *std::move(refused);
  }
  Result<void> written;
  if (command.record.bytes.empty()) {
    written = co_await node_.write(value.object, value.type, value.raw, command.deadline);
  } else {
    written = co_await node_.write_bytes(value.object, command.record.bytes, command.deadline);
  }
  if (written.has_error() && written.error().not_sent) {
    refused = refuse_waiting(command);
    co_return refused ? Outcome(*std::move(refused)) : Outcome(written);
  }
  co_return written;
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
