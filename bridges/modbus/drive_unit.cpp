#include "bridges/modbus/drive_unit.h"

#include <algorithm>
#include <array>
#include <utility>

#include "bridges/modbus/mbap.h"
#include "bridges/modbus/words.h"
#include "bridges/process/answer.h"
#include "canopen/hex.h"

namespace modbus {
namespace {

// Values of a refused write that the log names.
constexpr std::size_t kMostShown = 8;

// Bits of a command make no command.
std::optional<std::uint16_t> nmt_number(const Request& request) {
  if (request.function == Function::mask_write_register) {
    return request.and_mask == 0 ? std::optional(request.or_mask) : std::nullopt;
  }
  return static_cast<std::uint16_t>(request.values[0] << 8 | request.values[1]);
}

bool writes_nmt(const Request& request) {
  return !request.of_bits() && request.write == Range{.address = kNmtCommandRegister, .quantity = 1};
}

std::string where_of(const Request& request) {
  const std::uint32_t last = std::uint32_t{request.write.address} + request.write.quantity - 1;
  std::string where = (request.of_bits() ? "coil " : "register ") + std::to_string(request.write.address);
  if (request.write.quantity > 1) {
    where += " to " + std::to_string(last);
  }
  return where;
}

std::string hex_text(std::uint16_t value, unsigned digits) {
  return "0x" + canopen::hex(value, digits);
}

// `register 100 to 101: 0x0001 0x1388`
std::string asked_by(const Request& request) {
  if (request.function == Function::mask_write_register) {
    return where_of(request) + ": and " + hex_text(request.and_mask, 4) + ", or " + hex_text(request.or_mask, 4);
  }
  std::string text = where_of(request) + ":";
  const std::size_t width = request.of_bits() ? 1 : 2;
  const std::size_t shown = std::min(request.values.size(), kMostShown * width);
  for (std::size_t i = 0; i + width <= shown; i += width) {
    text += ' ' + (width == 1 ? hex_text(request.values[i], 2) : hex_text(word_at(request.values, i), 4));
  }
  return shown < request.values.size() ? text + " ..." : text;
}

// For log and journal; the client hears the exception alone.
canopen::Error mistake_of(Exception planned, const Request& request) {
  const std::string where = where_of(request);
  if (planned == Exception::illegal_address) {
    return {.kind = canopen::ErrorKind::read_only, .detail = where + " is not there, not all of a value, or read only"};
  }
  return {.kind = canopen::ErrorKind::type, .detail = "what was written to " + where + " is no value of the signal"};
}

Exception exception_of(const canopen::Error& error) {
  return Exception{process::answer_of(error.kind).modbus_exception};
}

}  // namespace

DriveUnit::DriveUnit(const process::Plant& plant, process::Drive& drive, config::WordOrder order)
    : plant_(plant), drive_(drive), table_(drive.model(), order) {
  const process::Image& image = drive.image();
  const std::size_t count = table_.drive().signals.size();
  measured_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto signal = static_cast<process::SignalId>(i);
    measured_.push_back(image.source_of(signal) != nullptr);
    show(signal);
  }
}

void DriveUnit::show(process::SignalId signal) {
  const process::Image& image = drive().image();
  table_.set(signal, measured_[signal] ? image.raw(signal) : drive().commanded().shown(signal));
}

void DriveUnit::on_values(std::span<const process::SignalId> signals) {
  for (const process::SignalId signal : signals) {
    show(signal);
  }
}

void DriveUnit::sign_of_life(const process::Writer& writer) {
  const config::Commands& commands = table_.drive().commands;
  // Where nobody waits for one there is nothing to do for each request.
  if (commands.writers.modbus && commands.timeout != canopen::Duration::zero()) {
    drive().sign_of_life(writer);
  }
}

DriveUnit::Quality DriveUnit::quality(process::SignalId signal, canopen::TimePoint now) const {
  if (signal == kNoSignal || !measured_[signal]) {
    return Quality::good;
  }
  const process::Image& image = drive().image();
  if (image.fresh(signal, now)) {
    return Quality::good;
  }
  return image.absent(signal) ? Quality::absent : Quality::stale;
}

bool DriveUnit::shows_zero(Quality found, config::OnStale on_stale) noexcept {
  return found == Quality::absent || (found == Quality::stale && on_stale == config::OnStale::zero);
}

std::optional<Exception> DriveUnit::read_registers(Range range, canopen::TimePoint now,
                                                   std::span<std::uint16_t> out) const {
  const config::OnStale on_stale = table_.drive().on_stale;
  const Diagnostics block = diagnostics(range, now);
  bool any_stale = false;
  process::SignalId looked_at = kNoSignal;
  Quality found = Quality::good;
  for (std::size_t i = 0; i < range.quantity; ++i) {
    const auto address = static_cast<std::uint16_t>(range.address + i);
    if (is_diagnostic(address)) {
      out[i] = block[address - kDiagnosticsBegin];
      continue;
    }
    if (!table_.has_register(address)) {
      return Exception::illegal_address;
    }
    const process::SignalId owner = table_.register_owner(address);
    if (owner != looked_at) {
      looked_at = owner;
      found = quality(owner, now);
      any_stale = any_stale || found == Quality::stale;
    }
    const bool as_zero = shows_zero(found, on_stale);
    out[i] = as_zero ? std::uint16_t{0} : table_.register_value(address);
  }
  if (any_stale && on_stale == config::OnStale::exception) {
    return Exception::no_response;
  }
  return std::nullopt;
}

std::optional<Exception> DriveUnit::read_bits(Range range, canopen::TimePoint now, std::span<std::uint8_t> out) const {
  const config::OnStale on_stale = table_.drive().on_stale;
  bool any_stale = false;
  for (std::size_t i = 0; i < range.quantity; ++i) {
    const auto address = static_cast<std::uint16_t>(range.address + i);
    if (!table_.has_bit(address)) {
      return Exception::illegal_address;
    }
    const Quality found = quality(table_.bit_owner(address), now);
    any_stale = any_stale || found == Quality::stale;
    out[i] = !shows_zero(found, on_stale) && table_.bit_value(address) ? 1 : 0;
  }
  if (any_stale && on_stale == config::OnStale::exception) {
    return Exception::no_response;
  }
  return std::nullopt;
}

Diagnostics DriveUnit::diagnostics(Range range, canopen::TimePoint now) const {
  const std::size_t end = std::size_t{range.address} + range.quantity;
  if (end <= kDiagnosticsBegin || range.address >= kDiagnosticsEnd) {
    return {};
  }
  Diagnostics block = diagnostics_of(drive(), table_.word_order(), now);
  const std::optional<alarms::FaultSource> first = plant_.first_out();
  block[kFirstOutRegister - kDiagnosticsBegin] = first && !first->bus && first->index == drive_.index() ? 1 : 0;
  block[kNmtCommandRegister - kDiagnosticsBegin] = last_nmt_command_;
  if (end <= kFreshBitsBegin || range.address >= kFreshBitsBegin + kFreshWords) {
    return block;
  }
  for (std::uint16_t address = 0; address < kCommonAddresses; ++address) {
    const process::SignalId owner = table_.register_owner(address);
    if (owner == kNoSignal) {
      continue;
    }
    if (measured_[owner] ? quality(owner, now) == Quality::good : drive().commanded().counts(owner)) {
      std::uint16_t& word = block[kFreshBitsBegin - kDiagnosticsBegin + address / 16U];
      word = static_cast<std::uint16_t>(word | 1U << (address % 16U));
    }
  }
  return block;
}

WritePlan DriveUnit::plan_mask(const Request& request) const {
  const process::SignalId owner = table_.register_owner(request.write.address);
  const config::Signal* signal = owner == kNoSignal ? nullptr : &table_.drive().signals[owner];
  if (signal == nullptr || !config::writable(signal->access) || signal->modbus.count != 1) {
    return {.fields = {}, .mistake = Exception::illegal_address};
  }
  const process::Mask mask{.and_mask = request.and_mask, .or_mask = request.or_mask};
  return {.fields = {{owner, mask}}};
}

WritePlan DriveUnit::plan(const Request& request, std::span<const std::uint8_t> bytes) const {
  if (request.function == Function::mask_write_register && !is_diagnostic(request.write.address)) {
    return plan_mask(request);
  }
  return request.of_bits() ? plan_bits(table_, request.write, bytes) : plan_registers(table_, request.write, bytes);
}

bool DriveUnit::is_stop(const Request& request) const {
  return drive().is_stop(plan(request, request.values).fields);
}

boost::asio::awaitable<std::optional<Exception>> DriveUnit::write(Request request, process::Origin origin) {
  if (writes_nmt(request)) {
    const std::optional<Exception> refused = co_await write_nmt(nmt_number(request), std::move(origin));
    co_return refused;
  }
  WritePlan planned = plan(request, request.values);
  if (planned.mistake && !drive().is_stop(planned.fields)) {
    co_return note_refused(request, std::move(origin), mistake_of(*planned.mistake, request));
  }
  const process::Outcome outcome = co_await drive().write(std::move(origin), std::move(planned.fields));
  if (outcome.has_error()) {
    co_return exception_of(outcome.error());
  }
  if (planned.mistake) {
    drive().remark("the stop was carried out, what stood beside it was not: " +
                   mistake_of(*planned.mistake, request).detail);
  }
  co_return planned.mistake;
}

Exception DriveUnit::note_refused(const Request& request, process::Origin origin, canopen::Error why) {
  using Kind = process::CommandRecord::Kind;
  const Kind kind = writes_nmt(request) ? Kind::nmt : Kind::write;
  why.detail += "; asked was " + asked_by(request);
  return exception_of(drive().refuse(std::move(origin), kind, std::move(why)).error());
}

boost::asio::awaitable<std::optional<Exception>> DriveUnit::write_nmt(std::optional<std::uint16_t> number,
                                                                      process::Origin origin) {
  const auto command = number ? canopen::nmt_command_of(*number) : std::nullopt;
  if (!command) {
    const process::Outcome told =
        drive().refuse(std::move(origin), process::CommandRecord::Kind::nmt,
                       {.kind = canopen::ErrorKind::type,
                        .detail = "register 1020 takes 1, 2, 128, 129 or 130" +
                                  (number ? ", not " + std::to_string(*number) : std::string())});
    co_return exception_of(told.error());
  }
  const process::Outcome outcome = co_await drive().nmt(std::move(origin), *command);
  if (outcome.has_error()) {
    co_return exception_of(outcome.error());
  }
  last_nmt_command_ = *number;
  co_return std::nullopt;
}

}  // namespace modbus
