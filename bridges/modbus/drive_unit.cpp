#include "bridges/modbus/drive_unit.h"

#include <array>
#include <utility>

#include "bridges/modbus/words.h"
#include "bridges/process/answer.h"

namespace modbus {
namespace {

Exception exception_of(const canopen::Error& error) {
  return Exception{process::answer_of(error.kind).modbus_exception};
}

}  // namespace

DriveUnit::DriveUnit(process::Plant& plant, std::size_t drive, config::WordOrder order)
    : plant_(plant),
      index_(drive),
      table_(plant.drive(drive).model(), order),
      known_commands_(plant.drive(drive).model()) {
  const process::Image& image = plant.drive(drive).image();
  const std::size_t count = table_.drive().signals.size();
  measured_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto signal = static_cast<process::SignalId>(i);
    measured_.push_back(image.source_of(signal) != nullptr);
    show(signal);
  }
  on_change();
}

void DriveUnit::show(process::SignalId signal) {
  const process::Image& image = drive().image();
  table_.set(signal, measured_[signal] ? image.raw(signal) : image.commanded(signal));
}

void DriveUnit::on_values(std::span<const process::SignalId> signals) {
  for (const process::SignalId signal : signals) {
    show(signal);
  }
  // The clock is read once per batch of frames, not here.
  const process::SourceState* const source = signals.empty() ? nullptr : drive().image().source_of(signals.front());
  known_commands_.observe(drive(), source != nullptr ? source->at : canopen::Clock::now());
}

void DriveUnit::on_commanded(std::span<const process::SignalId> signals) {
  const canopen::TimePoint now = canopen::Clock::now();
  for (const process::SignalId signal : signals) {
    show(signal);
    known_commands_.confirm(signal, drive().image().commanded(signal), now);
  }
}

void DriveUnit::on_outcome_unknown(std::span<const process::SignalId> signals) {
  for (const process::SignalId signal : signals) {
    known_commands_.forget(signal, canopen::Clock::now());
  }
}

void DriveUnit::on_change() {
  known_commands_.observe(drive(), canopen::Clock::now());
}

bool DriveUnit::stale(process::SignalId signal, canopen::TimePoint now) const {
  return signal != kNoSignal && measured_[signal] && !drive().image().fresh(signal, now);
}

std::optional<Exception> DriveUnit::read_registers(Range range, canopen::TimePoint now,
                                                   std::span<std::uint16_t> out) const {
  const config::OnStale on_stale = table_.drive().on_stale;
  const Diagnostics block = diagnostics(range, now);
  bool any_stale = false;
  process::SignalId looked_at = kNoSignal;
  bool looked_stale = false;
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
      looked_stale = stale(owner, now);
      any_stale = any_stale || looked_stale;
    }
    const bool as_zero = looked_stale && on_stale == config::OnStale::zero;
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
    const bool is_stale = stale(table_.bit_owner(address), now);
    any_stale = any_stale || is_stale;
    const bool as_zero = is_stale && on_stale == config::OnStale::zero;
    out[i] = !as_zero && table_.bit_value(address) ? 1 : 0;
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
  block[kNmtCommandRegister - kDiagnosticsBegin] = last_nmt_command_;
  if (end <= kFreshBitsBegin || range.address >= kFreshBitsBegin + kFreshWords) {
    return block;
  }
  for (std::uint16_t address = 0; address < kCommonAddresses; ++address) {
    const process::SignalId owner = table_.register_owner(address);
    if (owner != kNoSignal && measured_[owner] && !stale(owner, now)) {
      std::uint16_t& word = block[kFreshBitsBegin - kDiagnosticsBegin + address / 16U];
      word = static_cast<std::uint16_t>(word | 1U << (address % 16U));
    }
  }
  return block;
}

std::variant<std::uint16_t, Exception> DriveUnit::masked_word(const Request& request, canopen::TimePoint now) const {
  // MODBUS Application Protocol V1.1b3, section 6.16.
  const auto masked = [&request](std::uint16_t word) {
    return static_cast<std::uint16_t>((word & request.and_mask) | (request.or_mask & ~request.and_mask));
  };
  if (request.and_mask == 0) {
    return masked(0);  // Every bit is given, nothing has to be known.
  }
  if (request.write.address == kNmtCommandRegister) {
    return Exception::illegal_value;
  }
  const process::SignalId owner = table_.register_owner(request.write.address);
  if (owner == kNoSignal || table_.drive().signals[owner].modbus.count != 1) {
    return Exception::illegal_address;
  }
  const process::Image& image = drive().image();
  const process::SourceState* const source = image.source_of(owner);
  const auto confirmed = known_commands_.confirmed_at(owner);
  const auto forgotten = known_commands_.forgotten_at(owner);
  canopen::Raw raw = 0;
  if (confirmed && (source == nullptr || !source->received || *confirmed >= source->at)) {
    raw = image.commanded(owner);
  } else if (source == nullptr) {
    return Exception::illegal_value;  // Nobody commanded the bits to be kept; none is invented.
  } else if (image.fresh(owner, now) && !(forgotten && source->at <= *forgotten)) {
    raw = image.raw(owner);
  } else {
    return Exception::no_response;
  }
  std::array<std::uint16_t, 1> word{};
  put_value(table_.drive().signals[owner], raw, table_.word_order(), word);
  return masked(word[0]);
}

WritePlan DriveUnit::plan(const Request& request, std::span<const std::uint8_t> bytes) const {
  return request.of_bits() ? plan_bits(table_, request.write, bytes) : plan_registers(table_, request.write, bytes);
}

boost::asio::awaitable<std::optional<Exception>> DriveUnit::write(Request request, process::Origin origin) {
  std::array<std::uint8_t, 2> mask_result{};
  std::span<const std::uint8_t> bytes = request.values;
  process::StillStands still_stands;
  if (request.function == Function::mask_write_register) {
    const auto word = masked_word(request, canopen::Clock::now());
    if (const auto* const refused = std::get_if<Exception>(&word)) {
      co_return *refused;
    }
    const std::uint16_t result = std::get<std::uint16_t>(word);
    mask_result = {static_cast<std::uint8_t>(result >> 8), static_cast<std::uint8_t>(result)};
    bytes = mask_result;
    // Else it would bring back a run bit that a stop before it in the queue took away.
    still_stands = [this, &request, word] { return masked_word(request, canopen::Clock::now()) == word; };
  }
  if (!request.of_bits() && request.write == Range{.address = kNmtCommandRegister, .quantity = 1}) {
    const auto number = static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
    const std::optional<Exception> refused = co_await write_nmt(number, std::move(origin));
    co_return refused;
  }
  WritePlan planned = plan(request, bytes);
  if (const auto* const refused = std::get_if<Exception>(&planned)) {
    co_return *refused;
  }
  auto fields = std::get<std::vector<process::FieldWrite>>(std::move(planned));
  const std::optional<Exception> refused =
      co_await write_fields(std::move(fields), std::move(origin), std::move(still_stands));
  co_return refused;
}

boost::asio::awaitable<std::optional<Exception>> DriveUnit::write_nmt(std::uint16_t number, process::Origin origin) {
  const auto command = canopen::nmt_command_of(number);
  if (!command) {
    co_return Exception::illegal_value;
  }
  const process::Outcome outcome = co_await drive().nmt(std::move(origin), *command);
  if (outcome.has_error()) {
    co_return exception_of(outcome.error());
  }
  last_nmt_command_ = number;
  co_return std::nullopt;
}

boost::asio::awaitable<std::optional<Exception>> DriveUnit::write_fields(std::vector<process::FieldWrite> fields,
                                                                         process::Origin origin,
                                                                         process::StillStands still_stands) {
  const process::Outcome outcome =
      co_await drive().write(std::move(origin), std::move(fields), std::move(still_stands));
  if (outcome.has_value()) {
    co_return std::nullopt;
  }
  co_return exception_of(outcome.error());
}

}  // namespace modbus
