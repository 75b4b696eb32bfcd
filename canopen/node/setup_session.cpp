#include "canopen/node/setup_session.h"

#include <utility>

#include "canopen/communication_objects.h"
#include "canopen/hex.h"
#include "canopen/node/pdo_times.h"
#include "canopen/sdo/client.h"

namespace canopen {
namespace {

constexpr std::uint32_t kWriteOnly = 0x06010001;

// Aborts that say: length of service parameter does not match, is too high, is too low.
bool refuses_length(const Error& error) noexcept {
  return error.kind == ErrorKind::refused &&
         (error.abort == 0x06070010 || error.abort == 0x06070012 || error.abort == 0x06070013);
}

/// Heartbeat time, guard time; inhibit time and event timer of a PDO.
bool is_time(ObjectAddress object) noexcept {
  const unsigned area = object.index & 0xFE00U;
  const bool of_pdo =
      (area == 0x1400 || area == 0x1800) && (object.sub == kPdoInhibitTime || object.sub == kPdoEventTimer);
  return of_pdo || object == kProducerHeartbeat || object == kGuardTime;
}

/// The unsigned number of so many bytes; of 3, of none: nothing.
std::optional<DataType> unsigned_of(std::size_t bytes) noexcept {
  switch (bytes) {
    case 1:
      return DataType::u8;
    case 2:
      return DataType::u16;
    case 4:
      return DataType::u32;
    default:
      return std::nullopt;
  }
}

// Identifiers and mapping entries are read in hexadecimal, times and counts in decimal.
std::string value_text(DataType type, Raw raw) {
  if (type == DataType::u32) {
    return "0x" + hex(raw, 1);
  }
  return is_signed(type) ? std::to_string(static_cast<std::int64_t>(raw)) : std::to_string(raw);
}

// They are u16 whatever the width: some nodes leave more bytes undefined.
constexpr Raw kTimeMask = 0xFFFF;

Error wrong_width(ObjectAddress object, std::size_t bytes) {
  Error error;
  error.kind = ErrorKind::protocol;
  error.object = object;
  error.detail = "answer has " + std::to_string(bytes) + " bytes, a time has 2";
  return error;
}

Error interruption() {
  Error error;
  error.kind = ErrorKind::offline;
  return error;
}

}  // namespace

std::string difference_text(const SetupItem& item, Raw found) {
  return to_string(item.object) + " " + item.name + ": expected " + value_text(item.type, item.wanted) + ", found " +
         value_text(item.type, found);
}

boost::asio::awaitable<Result<Raw>> SetupSession::read(ObjectAddress object, DataType type) {
  if (context_.life.over()) {
    co_return interruption();
  }
  if (!is_time(object)) {
    const Result<Raw> result = co_await context_.sdo.read(object, type);
    answered_ = answered_ || result.has_value() || result.error().kind != ErrorKind::timeout;
    co_return result;
  }
  const Result<std::vector<std::uint8_t>> bytes = co_await context_.sdo.read_bytes(object, byte_length(type));
  answered_ = answered_ || bytes.has_value() || bytes.error().kind != ErrorKind::timeout;
  if (bytes.has_error()) {
    co_return bytes.error();
  }
  const std::optional<DataType> width = unsigned_of(bytes.value().size());
  if (!width) {
    co_return wrong_width(object, bytes.value().size());
  }
  widths_.insert_or_assign(object, *width);
  co_return decode_raw(*width, bytes.value()).value_or(0) & kTimeMask;
}

DataType SetupSession::width_of(ObjectAddress object, DataType type) const {
  const auto found = widths_.find(object);
  return found == widths_.end() ? type : found->second;
}

boost::asio::awaitable<Result<void>> SetupSession::write(ObjectAddress object, DataType type, Raw raw) {
  if (context_.life.over()) {
    co_return interruption();
  }
  ++written_;
  if (half_done_noted_) {
    context_.half_done = std::to_string(written_) + " objects were written, the last " + to_string(object);
  }
  const DataType held = width_of(object, type);
  const DataType width = normalise(held, raw) == raw ? held : type;  // Never cut: 512 in 8 bits would be 0, off.
  Result<void> written = co_await context_.sdo.write(object, width, raw);
  if (written.has_error() && width != type && refuses_length(written.error()) && !context_.life.over()) {
    written = co_await context_.sdo.write(object, type, raw);
  }
  co_return written;
}

boost::asio::awaitable<Result<void>> SetupSession::write(const SetupItem& item) {
  Result<void> written = co_await write(item.object, item.type, item.wanted);
  if (written.has_error() && refuses_length(written.error())) {
    const DataType width = width_of(item.object, item.type);
    const Raw most = normalise(width, ~Raw{0});
    if (most < item.wanted && will_do(item, most)) {
      written = co_await write(item.object, width, most);
    }
  }
  co_return written;
}

boost::asio::awaitable<SetupOutcome> SetupSession::ensure(SetupItem item) {
  SetupOutcome outcome;
  if (item.policy == SetupPolicy::assume) {
    co_return outcome;
  }
  item.wanted = normalise(item.type, item.wanted);
  const Result<Raw> found = co_await read(item.object, item.type);
  if (found.has_value()) {
    const Raw shown = found.value() & item.mask;
    outcome.confirmed = shown == item.wanted;
    if (outcome.confirmed) {
      co_return outcome;
    }
    if (inspecting() && will_do(item, shown)) {
      outcome.will_do = true;
      outcome.remark = difference_text(item, shown) + ", which will do";
      co_return outcome;
    }
    if (inspecting() || item.policy == SetupPolicy::verify) {
      outcome.failure = difference(difference_text(item, shown));
      co_return outcome;
    }
    co_return co_await correct(std::move(item), true);
  }
  if (is_absent(found.error())) {
    outcome.absent = true;
    outcome.remark = to_string(item.object) + " " + item.name + " does not exist in the drive";
    co_return outcome;
  }
  if (found.error().kind == ErrorKind::refused && found.error().abort == kWriteOnly) {
    if (inspecting() || item.policy == SetupPolicy::verify) {
      co_return outcome;
    }
    co_return co_await correct(std::move(item), false);
  }
  outcome.failure = failure(found.error(), item.name);
  co_return outcome;
}

boost::asio::awaitable<SetupOutcome> SetupSession::correct(SetupItem item, bool readable) {
  SetupOutcome outcome;
  const Result<void> written = co_await write(item);
  if (written.has_error()) {
    outcome.failure = failure(written.error(), item.name);
    co_return outcome;
  }
  if (!readable) {
    co_return outcome;
  }
  const Result<Raw> back = co_await read(item.object, item.type);
  if (back.has_error()) {
    outcome.failure = failure(back.error(), item.name);
    co_return outcome;
  }
  const Raw shown = back.value() & item.mask;
  if (shown != item.wanted && will_do(item, shown)) {
    outcome.will_do = true;
    outcome.remark = difference_text(item, shown) + " after it was written, which will do";
    co_return outcome;
  }
  if (shown != item.wanted) {
    outcome.failure = difference(difference_text(item, shown) + " after it was written");
  }
  outcome.confirmed = !outcome.failure;
  co_return outcome;
}

BootFailure SetupSession::failure(const Error& error, std::string_view name) const {
  if (error.not_sent || error.kind == ErrorKind::offline || context_.life.over()) {
    return {.interrupted = true};
  }
  const bool silent = error.kind == ErrorKind::timeout && !answered_;
  return {.letter = silent ? BootResult::no_answer : BootResult::not_configured,
          .text = std::string(name) + ": " + to_string(error),
          .cause = to_string(error.object) + " " + std::string(name_of(error.kind)) + " 0x" + hex(error.abort, 8)};
}

BootFailure SetupSession::difference(std::string text) const {
  return {inspecting() ? BootResult::left_alone : BootResult::not_configured, std::move(text), false};
}

}  // namespace canopen
