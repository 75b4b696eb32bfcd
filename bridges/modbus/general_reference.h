#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "bridges/modbus/exception.h"
#include "canopen/object.h"

// CANopen general reference, function 43/13 (CiA 309-2): an object of a drive, read or written through Modbus.

namespace modbus {

/// A request whose lengths are right.
struct Reference {
  bool write = false;
  std::uint8_t node = 0;
  canopen::ObjectAddress object;
  std::uint16_t start = 0;             ///< Of a read: the first byte wanted.
  std::uint16_t count = 0;             ///< Of a read: at most so many bytes; 0: all that fit.
  std::span<const std::uint8_t> data;  ///< Of a write: the object whole, lowest byte first; a view into the PDU.
};

/// `pdu` is of 43/13.
[[nodiscard]] std::variant<Reference, Exception> parse_reference(std::span<const std::uint8_t> pdu) noexcept;

/// What is answered to `pdu`, a read, where the object holds `bytes`.
[[nodiscard]] std::vector<std::uint8_t> bytes_read(std::span<const std::uint8_t> pdu, const Reference& reference,
                                                   std::span<const std::uint8_t> bytes);
/// And to a write that is confirmed.
[[nodiscard]] std::vector<std::uint8_t> written(std::span<const std::uint8_t> pdu);
/// And where the drive refused with this SDO abort code.
[[nodiscard]] std::vector<std::uint8_t> aborted(std::uint32_t code);

}  // namespace modbus
