#include "bridges/mqtt/sdo_request.h"

#include <charconv>
#include <string_view>
#include <utility>
#include <variant>

#include "bridges/mqtt/command.h"
#include "canopen/hex.h"

namespace mqtt {
namespace {

using canopen::DataType;
using canopen::Error;
using canopen::ErrorKind;
using canopen::Raw;
using canopen::Result;

Result<Raw> raw_of(DataType type, const Scalar& value) {
  if (value.kind == Scalar::Kind::boolean && type == DataType::boolean) {
    return Raw{value.text == "true" ? 1U : 0U};
  }
  if (value.kind != Scalar::Kind::number) {
    return type_error("\"value\" is not a value of type " + std::string(canopen::name_of(type)));
  }
  const Result<process::GivenValue> number = number_in(type, value.text);
  if (number.has_error()) {
    return number.error();
  }
  if (const Raw* exact = std::get_if<Raw>(&number.value())) {
    return *exact;
  }
  const auto raw = canopen::from_number(type, std::get<double>(number.value()));
  if (!raw) {
    return Error{.kind = ErrorKind::range,
                 .detail = value.text + " is out of the range of " + std::string(canopen::name_of(type))};
  }
  return *raw;
}

// Nothing where the text is not pairs of hexadecimal digits.
std::optional<std::vector<std::uint8_t>> bytes_of(std::string_view digits) {
  std::vector<std::uint8_t> bytes;
  for (; digits.size() >= 2; digits.remove_prefix(2)) {
    std::uint8_t byte = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + 2, byte, 16);
    if (error != std::errc{} || end != digits.data() + 2) {
      return std::nullopt;
    }
    bytes.push_back(byte);
  }
  return digits.empty() ? std::optional(std::move(bytes)) : std::nullopt;
}

Result<std::vector<std::uint8_t>> data_of(SdoForm form, const Scalar& value) {
  const bool is_text = form == SdoForm::text;
  if (value.kind != Scalar::Kind::string) {
    return type_error(std::string("\"value\" of type ") + (is_text ? "string" : "bytes") + " is to be a string");
  }
  std::optional<std::vector<std::uint8_t>> data =
      is_text ? std::vector<std::uint8_t>(value.text.begin(), value.text.end()) : bytes_of(value.text);
  if (!data) {
    return type_error("\"value\" of type bytes is to be hexadecimal digits, two for each byte");
  }
  if (data->empty()) {
    return type_error("\"value\" is empty; SDO writes one byte at least");
  }
  return *std::move(data);
}

std::optional<Error> take_type(const std::string* name, SdoRequest& request) {
  const auto type = name != nullptr ? canopen::parse_type(*name) : std::nullopt;
  if (type) {
    request.type = *type;
  } else if (name != nullptr && *name == "string") {
    request.form = SdoForm::text;
  } else if (name != nullptr && *name == "bytes") {
    request.form = SdoForm::bytes;
  } else {
    return type_error("\"type\" is to be one of bool, u8, u16, u32, u64, i8, i16, i32, i64, f32, f64, string, bytes");
  }
  return std::nullopt;
}

std::optional<Error> take_value(const Scalar& value, SdoRequest& request) {
  if (request.form == SdoForm::number) {
    const Result<Raw> raw = raw_of(request.type, value);
    if (raw.has_error()) {
      return raw.error();
    }
    request.value = raw.value();
    return std::nullopt;
  }
  Result<std::vector<std::uint8_t>> data = data_of(request.form, value);
  if (data.has_error()) {
    return data.error();
  }
  request.data = std::move(data.value());
  return std::nullopt;
}

}  // namespace

Result<SdoRequest> sdo_request_of(const FlatObject& members) {
  if (const auto unknown = text::unknown_member(members, {"op", "object", "type", "value"})) {
    return *unknown;
  }
  const std::string* const op = text::find_string(members, "op");
  if (op == nullptr) {
    return type_error("\"op\" is to be a string");
  }
  if (*op != "read" && *op != "write") {
    return Error{.kind = ErrorKind::unknown, .detail = "\"op\" is to be \"read\" or \"write\""};
  }
  const std::string* const object = text::find_string(members, "object");
  const auto address = object != nullptr ? canopen::parse_object(*object) : std::nullopt;
  if (!address) {
    return type_error("\"object\" is to be an address like \"0x2002:03\"");
  }
  SdoRequest request{.object = *address};
  if (const auto refused = take_type(text::find_string(members, "type"), request)) {
    return *refused;
  }
  const Scalar* const value = text::find_member(members, "value");
  if (*op == "read") {
    return value == nullptr ? Result<SdoRequest>(std::move(request)) : type_error("a read has no \"value\"");
  }
  if (value == nullptr) {
    return type_error("\"value\" is missing");
  }
  if (const auto refused = take_value(*value, request)) {
    return *refused;
  }
  return request;
}

std::string sdo_text(SdoForm form, const std::vector<std::uint8_t>& data) {
  std::string text;
  if (form == SdoForm::text) {
    text.assign(data.begin(), data.end());
    text.erase(text.find_last_not_of('\0') + 1);
    return text;
  }
  for (const std::uint8_t byte : data) {
    text += canopen::hex(byte, 2);
  }
  return text;
}

}  // namespace mqtt
