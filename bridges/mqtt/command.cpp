#include "bridges/mqtt/command.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "bridges/text/number_text.h"

namespace mqtt {
namespace {

using canopen::Error;
using canopen::ErrorKind;
using canopen::Raw;
using canopen::Result;

constexpr std::string_view kSpace = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

// What plain text stands for; the signal decides what a word means.
Scalar plain_scalar(std::string_view text) {
  if (text == "true" || text == "false") {
    return {Scalar::Kind::boolean, std::string(text)};
  }
  const Result<double> number = text::number_of(text);
  const bool numeric = number.has_value() || number.error().kind == ErrorKind::range;
  return {numeric ? Scalar::Kind::number : Scalar::Kind::string, std::string(text)};
}

// A fraction or an exponent makes it no integer.
bool is_integer(std::string_view text) {
  const std::size_t sign = text.starts_with('-') ? 1 : 0;
  return text.size() > sign && text.find_first_not_of("0123456789", sign) == std::string_view::npos;
}

// Of digits, so all that can be wrong is the size, or a minus where there is no sign.
template <class Integer>
Result<process::GivenValue> integer_of(std::string_view text) {
  Integer value{};
  if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc{}) {
    return Error{.kind = ErrorKind::range, .detail = std::string(text) + " is out of the type's range"};
  }
  return process::GivenValue(static_cast<Raw>(value));
}

// Moves the id out of the members.
void take_id(Parsed& parsed) {
  FlatObject& members = parsed.members.value();
  const auto id = std::ranges::find(members, "id", &FlatObject::value_type::first);
  if (id == members.end()) {
    return;
  }
  const Scalar value = std::move(id->second);
  members.erase(id);
  if (const auto echoed = text::echoed_id(value)) {
    parsed.id = *echoed;
    parsed.id_text = value.text;
  } else {
    parsed.members = type_error("\"id\" is to be a string or a number");
  }
}

Result<Raw> named_raw(const config::Signal& signal, const std::string& name) {
  std::string known;
  for (const auto& [raw, text] : signal.values) {
    if (text == name) {
      return canopen::normalise(signal.type, static_cast<Raw>(raw));
    }
    known += known.empty() ? text : ", " + text;
  }
  if (signal.values.empty()) {
    return type_error(signal.name + ": \"" + name.substr(0, 64) + "\" is not a number");
  }
  return type_error(signal.name + ": \"" + name.substr(0, 64) + "\" is none of " + known);
}

}  // namespace

Error type_error(std::string detail) {
  return {.kind = ErrorKind::type, .detail = std::move(detail)};
}

// A whole number in a 64-bit integer type, which a double would round, is its raw value.
Result<process::GivenValue> number_in(canopen::DataType type, std::string_view text) {
  if (type == canopen::DataType::i64 && is_integer(text)) {
    return integer_of<std::int64_t>(text);
  }
  if (type == canopen::DataType::u64 && is_integer(text)) {
    return integer_of<std::uint64_t>(text == "-0" ? "0" : text);
  }
  const Result<double> number = text::number_of(text);
  return number.has_value() ? Result<process::GivenValue>(number.value()) : number.error();
}

Parsed parse_value(std::string_view payload) {
  const std::string_view text = trimmed(payload);
  if (!text.starts_with('{') && payload.size() <= kMaxCommand) {
    return {{}, FlatObject{{"value", plain_scalar(text)}}};
  }
  Parsed parsed = parse_object_payload(payload);
  if (parsed.members.has_error()) {
    return parsed;
  }
  if (const auto unknown = unknown_member(parsed.members.value(), {"value"})) {
    parsed.members = *unknown;
  } else if (parsed.members.value().empty()) {
    parsed.members = type_error("\"value\" is missing");
  }
  return parsed;
}

Parsed parse_object_payload(std::string_view payload) {
  if (payload.size() > kMaxCommand) {
    return {{}, type_error("the payload is longer than " + std::to_string(kMaxCommand) + " bytes")};
  }
  Parsed parsed{{}, text::parse_flat(payload)};
  if (parsed.members.has_value()) {
    take_id(parsed);
  }
  return parsed;
}

Result<process::FieldWrite> field_of(const config::Drive& drive, std::size_t position, const Scalar& value) {
  const config::Signal& signal = drive.signals.at(position);
  const auto id = static_cast<process::SignalId>(position);
  if (!config::writable(signal.access)) {
    return Error{.kind = ErrorKind::read_only, .detail = signal.name + " takes no values"};
  }
  switch (value.kind) {
    case Scalar::Kind::null:
      return type_error(signal.name + ": null is no value");
    case Scalar::Kind::boolean:
      if (!signal.derived && signal.type != canopen::DataType::boolean) {
        return type_error(signal.name + ": " + value.text + " is not a number");
      }
      return process::FieldWrite{id, Raw{value.text == "true" ? 1U : 0U}};
    case Scalar::Kind::string: {
      const Result<Raw> raw = named_raw(signal, value.text);
      return raw.has_value() ? Result<process::FieldWrite>(process::FieldWrite{id, raw.value()}) : raw.error();
    }
    case Scalar::Kind::number:
      break;
  }
  // Only of a signal without a scale a raw value is what is meant.
  const auto number = number_in(signal.scale == 1.0 ? signal.type : canopen::DataType::f64, value.text);
  if (number.has_error()) {
    Error error = number.error();
    error.detail = signal.name + ": " + error.detail;
    return error;
  }
  return process::FieldWrite{id, number.value()};
}

Fields fields_of(const config::Drive& drive, const FlatObject& members) {
  Fields fields;
  if (members.empty()) {
    fields.mistake = type_error("no signal is named");
  }
  for (const auto& [name, value] : members) {
    const auto signal = drive.find(name);
    const Result<process::FieldWrite> field =
        signal ? field_of(drive, *signal, value)
               : Error{.kind = ErrorKind::unknown, .detail = drive.name + " has no signal \"" + name + "\""};
    if (field.has_value()) {
      fields.sound.push_back(field.value());
    } else if (!fields.mistake) {
      fields.mistake = field.error();
    }
  }
  return fields;
}

Result<canopen::NmtCommand> nmt_command_of(const FlatObject& members) {
  const std::string* const name = text::find_string(members, "value");
  const auto command = name != nullptr ? canopen::parse_nmt_command(*name) : std::nullopt;
  if (!command) {
    return Error{.kind = ErrorKind::unknown,
                 .detail =
                     "no such NMT command; known are start, stop, pre-operational, reset-node, "
                     "reset-communication"};
  }
  return *command;
}

}  // namespace mqtt
