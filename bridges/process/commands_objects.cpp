// Any object, read and written by SDO.

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>

#include "bridges/process/command_checks.h"
#include "bridges/process/commands.h"
#include "canopen/node/remote_node.h"

namespace process {
namespace {

using boost::asio::awaitable;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Raw;
using canopen::Result;

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

awaitable<Result<std::vector<std::uint8_t>>> Commands::read_whole(canopen::ObjectAddress object, std::size_t expected) {
  if (closed_) {
    co_return closed_error();
  }
  if (Refusal refused = refuse_out_of_service()) {
    co_return *std::move(refused);
  }
  const Visit visit(*this);
  Result<std::vector<std::uint8_t>> answer = co_await node_.read_bytes(object, expected);
  co_return answer;
}

awaitable<Result<Raw>> Commands::sdo_read(canopen::ObjectAddress object, canopen::DataType type) {
  const std::size_t length = canopen::byte_length(type);
  const Result<std::vector<std::uint8_t>> bytes = co_await read_whole(object, length);
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
  const auto signal = std::ranges::find(model_.signals, object, &config::Signal::object);
  const std::size_t expected = signal == model_.signals.end() ? 0 : canopen::byte_length(signal->type);
  Result<std::vector<std::uint8_t>> answer = co_await read_whole(object, expected);
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

}  // namespace process
