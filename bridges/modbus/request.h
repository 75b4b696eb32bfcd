#pragma once

#include <cstdint>
#include <span>
#include <variant>

#include "bridges/modbus/exception.h"

namespace modbus {

enum class Function : std::uint8_t {
  read_coils = 1,
  read_discrete_inputs = 2,
  read_holding_registers = 3,
  read_input_registers = 4,
  write_single_coil = 5,
  write_single_register = 6,
  write_multiple_coils = 15,
  write_multiple_registers = 16,
  mask_write_register = 22,
  read_write_multiple_registers = 23,
  encapsulated_interface = 43
};

/// Addresses `address` .. `address + quantity - 1`; never beyond 65535.
struct Range {
  std::uint16_t address = 0;
  std::uint16_t quantity = 0;
  friend bool operator==(const Range&, const Range&) = default;
};

/// What function 43 carries: the MEI type, the byte behind the function code.
enum class Encapsulated : std::uint8_t {
  canopen = 13,               ///< CANopen general reference (CiA 309-2).
  device_identification = 14  ///< MODBUS Application Protocol V1.1b3, section 6.21.
};

inline constexpr std::uint16_t kMaxReadBits = 2000;
inline constexpr std::uint16_t kMaxReadRegisters = 125;

/// A request whose lengths, quantities and ranges are right; whether the addresses exist is the unit's business.
struct Request {
  Function function = Function::read_holding_registers;
  Range read{};   ///< Functions 1 to 4 and 23.
  Range write{};  ///< Functions 5, 6, 15, 16, 22 and 23.
  /// What to write, a view into the frame: registers high byte first; bits eight to a byte, lowest first (also of
  /// function 5). Empty for function 22.
  std::span<const std::uint8_t> values{};
  std::uint16_t and_mask = 0;  ///< Function 22.
  std::uint16_t or_mask = 0;
  /// Function 43: the whole PDU, a view into the frame, at least two bytes with an MEI type that is known. What else
  /// it says is the business of who answers it.
  std::span<const std::uint8_t> encapsulated{};

  [[nodiscard]] bool reads() const noexcept { return read.quantity != 0; }
  [[nodiscard]] bool writes() const noexcept { return write.quantity != 0; }
  [[nodiscard]] bool is_encapsulated() const noexcept { return !encapsulated.empty(); }
  /// Addresses are those of bits, not of registers.
  [[nodiscard]] bool of_bits() const noexcept;
};

/// `pdu` begins with the function code and ends where the MBAP header says so. Nothing may be missing or left over.
[[nodiscard]] std::variant<Request, Exception> parse_request(std::span<const std::uint8_t> pdu) noexcept;

}  // namespace modbus
