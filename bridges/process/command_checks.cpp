#include "bridges/process/command_checks.h"

#include <algorithm>
#include <array>
#include <utility>

#include "config/value_check.h"

namespace process {
namespace {

using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

// PDO communication and mapping (CiA 301 §7.5.2.35 to 38).
bool is_pdo_setup(canopen::ObjectAddress object) {
  return object.index >= 0x1400 && object.index <= 0x1BFF;
}

bool is_allowed(const config::Writers& writers, Writer::Way way) {
  switch (way) {
    case Writer::Way::modbus:
      return writers.modbus;
    case Writer::Way::mqtt:
      return writers.mqtt;
    case Writer::Way::local:
      return writers.local;
    case Writer::Way::gateway:
      break;
  }
  return true;  // What the site itself has written down.
}

bool is_writable(const config::Signal& signal) {
  return config::writable(signal.access) && !signal.derived;
}

Result<Field> check_field(const config::Drive& model, const FieldWrite& write) {
  if (write.signal >= model.signals.size()) {
    return command_error(model, ErrorKind::unknown, "no such signal");
  }
  const config::Signal& signal = model.signals[write.signal];
  Result<canopen::Raw> raw =
      is_writable(signal) ? check_given(signal, write)
                          : Result<canopen::Raw>(command_error(model, ErrorKind::read_only, "cannot be written"));
  if (raw.has_value()) {
    return Field{write.signal, raw.value()};
  }
  Error refused = raw.error();
  refused.node = model.node.node;
  refused.object = signal.object;
  return refused;
}

}  // namespace

Result<canopen::Raw> check_given(const config::Signal& signal, const FieldWrite& write) {
  if (const auto* raw = std::get_if<canopen::Raw>(&write.value)) {
    return check_value(signal, *raw);
  }
  if (const auto* number = std::get_if<double>(&write.value)) {
    return check_value(signal, *number);
  }
  return canopen::Error{.kind = ErrorKind::incomplete, .detail = "nobody commanded the bits to be kept"};
}

config::Signal without_limits(const config::Signal& signal) {
  config::Signal copy = signal;
  copy.min.reset();
  copy.max.reset();
  return copy;
}

std::optional<Error> refuse_writer(const config::Drive& model, const Writer& writer) {
  if (is_allowed(model.commands.writers, writer.way)) {
    return std::nullopt;
  }
  return command_error(model, ErrorKind::forbidden, to_string(writer) + " is none of the writers of " + model.name);
}

std::optional<Error> refuse_raw(const config::Drive& model, canopen::ObjectAddress object) {
  if (!model.commands.raw) {
    return command_error(model, ErrorKind::forbidden, "no writable signal, and raw writes are not allowed");
  }
  if (is_pdo_setup(object)) {
    return command_error(model, ErrorKind::forbidden, "what PDOs carry is set up by the configuration only");
  }
  return std::nullopt;
}

Result<std::vector<Field>> check_fields(const config::Drive& model, const std::vector<FieldWrite>& fields) {
  if (fields.empty()) {
    return command_error(model, ErrorKind::unknown, "no signal to write");
  }
  std::vector<Field> checked;
  for (const FieldWrite& write : fields) {
    const Result<Field> field = check_field(model, write);
    if (field.has_value()) {
      checked.push_back(field.value());
      continue;
    }
    Error refused = field.error();
    if (fields.size() > 1 && write.signal < model.signals.size()) {
      refused.detail = model.signals[write.signal].name + ": " + refused.detail;
    }
    return refused;
  }
  return checked;
}

std::optional<SignalId> writable_signal(const config::Drive& model, canopen::ObjectAddress object) {
  const auto found = std::find_if(model.signals.begin(), model.signals.end(), [&](const config::Signal& signal) {
    return signal.object == object && is_writable(signal);
  });
  if (found == model.signals.end()) {
    return std::nullopt;
  }
  return static_cast<SignalId>(found - model.signals.begin());
}

// CiA 301 table 22: what a drive answers that does not take a mapped object by SDO at all.
bool takes_no_sdo(const Error& error) noexcept {
  constexpr std::array kCodes{0x06010000U, 0x06010002U, 0x06020000U, 0x06090011U};
  return error.kind == ErrorKind::refused && std::find(kCodes.begin(), kCodes.end(), error.abort) != kCodes.end();
}

Error with_written(Error error, const std::string& names) {
  if (!names.empty()) {
    error.detail.append(error.detail.empty() ? "" : "; ").append("already written: ").append(names);
  }
  return error;
}

Error command_error(const config::Drive& model, ErrorKind kind, std::string detail) {
  Error error;
  error.kind = kind;
  error.node = model.node.node;
  error.detail = std::move(detail);
  return error;
}

}  // namespace process
