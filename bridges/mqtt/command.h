#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bridges/process/drive.h"
#include "bridges/text/flat_json.h"
#include "canopen/error.h"
#include "config/model.h"

namespace mqtt {

using text::FlatObject;
using text::Scalar;

/// Longer payloads are refused as `type` unread.
inline constexpr std::size_t kMaxCommand = 16UL * 1024;

/// A command's payload taken apart: its value or members, and the id to echo.
struct Parsed {
  /// A string or a number, as JSON text; empty: none.
  std::string id;
  canopen::Result<FlatObject> members;  ///< Without `id`.
  std::string id_text{};                ///< The id as journal and log show it: the string's characters, or the digits.
};

/// Of `<signal>/set` and `nmt/set`: plain text or `{"value":…,"id":…}`; one member, `value`.
[[nodiscard]] Parsed parse_value(std::string_view payload);
/// Of `set` and `sdo/request`: an object.
[[nodiscard]] Parsed parse_object_payload(std::string_view payload);

/// The value for one signal. Numbers are in engineering units; booleans and enumerated names stand for their raw value.
/// `read_only`, `type` and, for what a 64-bit type cannot hold, `range`.
[[nodiscard]] canopen::Result<process::FieldWrite> field_of(const config::Drive& drive, std::size_t signal,
                                                            const Scalar& value);
/// A mistake of kind `type`.
[[nodiscard]] canopen::Error type_error(std::string detail);

/// The number that a text is, for a value of this type: of the 64-bit ones the exact raw value where it is written as a
/// whole number. `type`, `range`.
[[nodiscard]] canopen::Result<process::GivenValue> number_in(canopen::DataType type, std::string_view text);

/// What several members write.
struct Fields {
  std::vector<process::FieldWrite> sound{};  ///< In their order.
  std::optional<canopen::Error> mistake{};   ///< The first; what is sound may be a stop all the same.
};
/// Every member is to be a signal of the drive; at least one.
[[nodiscard]] Fields fields_of(const config::Drive& drive, const FlatObject& members);

[[nodiscard]] canopen::Result<canopen::NmtCommand> nmt_command_of(const FlatObject& members);

}  // namespace mqtt
