#include "bridges/modbus/request.h"

#include <array>
#include <cstddef>

#include "bridges/modbus/mbap.h"

namespace modbus {
namespace {

// Limits of the MODBUS Application Protocol V1.1b3, section 6.
constexpr std::uint16_t kMaxWriteBits = 1968;
constexpr std::uint16_t kMaxWriteRegisters = 123;
constexpr std::uint16_t kMaxReadWriteRegisters = 121;
constexpr std::uint16_t kCoilOn = 0xFF00;
constexpr std::uint16_t kCoilOff = 0x0000;

using Bytes = std::span<const std::uint8_t>;
using Parsed = std::variant<Request, Exception>;

bool within_addresses(Range range) noexcept {
  return std::size_t{range.address} + range.quantity <= 0x10000;
}

bool within(Range range, std::uint16_t most) noexcept {
  return range.quantity >= 1 && range.quantity <= most;
}

Parsed parse_read(Bytes pdu, std::uint16_t most) noexcept {
  if (pdu.size() != 5) {
    return Exception::illegal_value;
  }
  const Range range{.address = word_at(pdu, 1), .quantity = word_at(pdu, 3)};
  if (!within(range, most)) {
    return Exception::illegal_value;
  }
  if (!within_addresses(range)) {
    return Exception::illegal_address;
  }
  return Request{.function = Function{pdu[0]}, .read = range, .write = {}, .values = {}};
}

Parsed parse_single_coil(Bytes pdu) noexcept {
  static constexpr std::array<std::uint8_t, 1> kOn{1};
  static constexpr std::array<std::uint8_t, 1> kOff{0};
  if (pdu.size() != 5) {
    return Exception::illegal_value;
  }
  const std::uint16_t value = word_at(pdu, 3);
  if (value != kCoilOn && value != kCoilOff) {
    return Exception::illegal_value;
  }
  return Request{.function = Function::write_single_coil,
                 .read = {},
                 .write = {.address = word_at(pdu, 1), .quantity = 1},
                 .values = value == kCoilOn ? Bytes(kOn) : Bytes(kOff)};
}

Parsed parse_single_register(Bytes pdu) noexcept {
  if (pdu.size() != 5) {
    return Exception::illegal_value;
  }
  return Request{.function = Function::write_single_register,
                 .read = {},
                 .write = {.address = word_at(pdu, 1), .quantity = 1},
                 .values = pdu.subspan(3)};
}

Parsed parse_multiple(Bytes pdu, std::uint16_t most, bool bits) noexcept {
  if (pdu.size() < 6) {
    return Exception::illegal_value;
  }
  const Range range{.address = word_at(pdu, 1), .quantity = word_at(pdu, 3)};
  const Bytes values = pdu.subspan(6);
  const std::size_t needed = bits ? (range.quantity + 7U) / 8U : range.quantity * 2U;
  // What was announced, what is needed and what was sent must agree.
  if (!within(range, most) || pdu[5] != needed || values.size() != needed) {
    return Exception::illegal_value;
  }
  if (!within_addresses(range)) {
    return Exception::illegal_address;
  }
  return Request{.function = Function{pdu[0]}, .read = {}, .write = range, .values = values};
}

Parsed parse_mask(Bytes pdu) noexcept {
  if (pdu.size() != 7) {
    return Exception::illegal_value;
  }
  return Request{.function = Function::mask_write_register,
                 .read = {},
                 .write = {.address = word_at(pdu, 1), .quantity = 1},
                 .values = {},
                 .and_mask = word_at(pdu, 3),
                 .or_mask = word_at(pdu, 5)};
}

Parsed parse_read_write(Bytes pdu) noexcept {
  if (pdu.size() < 10) {
    return Exception::illegal_value;
  }
  const Range read{.address = word_at(pdu, 1), .quantity = word_at(pdu, 3)};
  const Range write{.address = word_at(pdu, 5), .quantity = word_at(pdu, 7)};
  const Bytes values = pdu.subspan(10);
  const std::size_t needed = std::size_t{2} * write.quantity;
  if (!within(read, kMaxReadRegisters) || !within(write, kMaxReadWriteRegisters) || pdu[9] != needed ||
      values.size() != needed) {
    return Exception::illegal_value;
  }
  if (!within_addresses(read) || !within_addresses(write)) {
    return Exception::illegal_address;
  }
  return Request{.function = Function::read_write_multiple_registers, .read = read, .write = write, .values = values};
}

Parsed parse_encapsulated(Bytes pdu) noexcept {
  if (pdu.size() < 2) {
    return Exception::illegal_value;
  }
  switch (Encapsulated{pdu[1]}) {
    case Encapsulated::canopen:
    case Encapsulated::device_identification:
      return Request{.function = Function::encapsulated_interface, .encapsulated = pdu};
  }
  return Exception::illegal_function;
}

}  // namespace

bool Request::of_bits() const noexcept {
  return function == Function::read_coils || function == Function::read_discrete_inputs ||
         function == Function::write_single_coil || function == Function::write_multiple_coils;
}

Parsed parse_request(Bytes pdu) noexcept {
  if (pdu.empty()) {
    return Exception::illegal_function;
  }
  switch (Function{pdu[0]}) {
    case Function::read_coils:
    case Function::read_discrete_inputs:
      return parse_read(pdu, kMaxReadBits);
    case Function::read_holding_registers:
    case Function::read_input_registers:
      return parse_read(pdu, kMaxReadRegisters);
    case Function::write_single_coil:
      return parse_single_coil(pdu);
    case Function::write_single_register:
      return parse_single_register(pdu);
    case Function::write_multiple_coils:
      return parse_multiple(pdu, kMaxWriteBits, true);
    case Function::write_multiple_registers:
      return parse_multiple(pdu, kMaxWriteRegisters, false);
    case Function::mask_write_register:
      return parse_mask(pdu);
    case Function::read_write_multiple_registers:
      return parse_read_write(pdu);
    case Function::encapsulated_interface:
      return parse_encapsulated(pdu);
  }
  return Exception::illegal_function;
}

}  // namespace modbus
