#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridges/text/flat_json.h"
#include "canopen/error.h"
#include "canopen/object.h"

namespace mqtt {

/// How a request writes a value, and its answer: as a number (or a boolean) of a basic type, as text, or as the bytes
/// that SDO carries, two hexadecimal digits each.
enum class SdoForm : std::uint8_t { number, text, bytes };

/// `{"op":"read","object":"0x2002:03","type":"u16"}`; a write has a `value`, raw as the device holds it.
struct SdoRequest {
  canopen::ObjectAddress object{};
  SdoForm form = SdoForm::number;
  canopen::DataType type = canopen::DataType::u16;  ///< Of a number.
  std::optional<canopen::Raw> value{};              ///< A number to be written.
  std::vector<std::uint8_t> data{};                 ///< Text or bytes to be written, at least one.

  [[nodiscard]] bool writes() const noexcept { return value.has_value() || !data.empty(); }
};

/// `type`, `unknown` for an `op` that there is not, `range` for a number that the type cannot hold.
[[nodiscard]] canopen::Result<SdoRequest> sdo_request_of(const text::FlatObject& members);

/// What was read, as the value of an answer: text without the zeros behind it, or hexadecimal digits.
[[nodiscard]] std::string sdo_text(SdoForm form, const std::vector<std::uint8_t>& data);

}  // namespace mqtt
