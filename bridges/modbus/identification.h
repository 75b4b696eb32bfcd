#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "bridges/modbus/encapsulated.h"
#include "bridges/modbus/exception.h"
#include "config/model.h"

// Read device identification, function 43/14 (MODBUS Application Protocol V1.1b3, section 6.21).

namespace modbus {

/// The ids of the standard, and of ours from 0x80 on.
enum class IdentityId : std::uint8_t {
  vendor_name = 0x00,
  product_code = 0x01,
  revision = 0x02,
  product_name = 0x04,
  model_name = 0x05,
  user_application_name = 0x06,
  name = 0x80,
  profile = 0x81,
  serial_number = 0x82,
  hardware_version = 0x83,
  software_version = 0x84
};

struct IdentityObject {
  IdentityId id;
  /// ASCII. An exception: it cannot be told just now. A stream leaves it out, and who asks for it alone hears why.
  std::variant<std::string, Exception> text;
};

/// What is known without asking anybody, in order of ids: of the gateway, and of a drive as the gateway shows it. That
/// of a drive ends where told_identity() goes on; `bus` is its position in `model`.
[[nodiscard]] std::vector<IdentityObject> identity_of_gateway(const config::Model& model);
[[nodiscard]] std::vector<IdentityObject> identity_of_drive(const config::Model& model, const config::Drive& drive,
                                                            std::size_t bus);

/// Whether the answer to `pdu` may need the object. One of the extended category.
[[nodiscard]] bool asks_for(std::span<const std::uint8_t> pdu, IdentityId id) noexcept;

/// Answers `pdu`, which is of 43/14, out of `objects`, which are in order of ids and begin with the three of the basic
/// category.
[[nodiscard]] EncapsulatedAnswer identify(std::span<const std::uint8_t> pdu, std::span<const IdentityObject> objects);

}  // namespace modbus
