#include "bridges/mqtt/asked.h"

#include <string>
#include <utility>
#include <vector>

#include "bridges/process/command_checks.h"
#include "bridges/process/stop_check.h"

namespace mqtt {
namespace {

using canopen::Error;
using canopen::ErrorKind;
using canopen::Result;

template <class T>
Result<Asked> asked(Result<T> result) {
  return result.has_value() ? Result<Asked>(Asked(std::move(result.value()))) : Result<Asked>(result.error());
}

// The signals that it writes, by whatever way.
std::vector<process::FieldWrite> written_by(const config::Drive& drive, const Asked& asked) {
  if (const auto* fields = std::get_if<Fields>(&asked)) {
    return fields->sound;
  }
  const auto* request = std::get_if<SdoRequest>(&asked);
  const auto signal = request != nullptr ? process::writable_signal(drive, request->object) : std::nullopt;
  if (!signal) {
    return {};
  }
  if (request->value) {
    return {{*signal, *request->value}};
  }
  const canopen::DataType type = drive.signals[*signal].type;
  const auto raw =
      request->data.size() == canopen::byte_length(type) ? canopen::decode_raw(type, request->data) : std::nullopt;
  return raw ? std::vector<process::FieldWrite>{{*signal, *raw}} : std::vector<process::FieldWrite>{};
}

}  // namespace

bool carries_command(const Route& route) noexcept {
  using Kind = Route::Kind;
  return route.kind != Kind::alarm && route.kind != Kind::status && route.kind != Kind::life &&
         route.kind != Kind::alive;
}

Parsed parse_command(const Route& route, std::string_view payload) {
  const bool value =
      route.kind == Route::Kind::set_signal || route.kind == Route::Kind::nmt || route.kind == Route::Kind::stop_all;
  return value ? parse_value(payload) : parse_object_payload(payload);
}

Result<Asked> asked_of(const config::Drive* drive, const Route& route, const Parsed& parsed) {
  if (route.kind == Route::Kind::stop_all) {
    return Asked(StopAll{});
  }
  if (drive == nullptr) {
    return Error{.kind = ErrorKind::unknown, .detail = "no drive \"" + std::string(route.drive) + "\""};
  }
  if (route.kind == Route::Kind::set_signal && !drive->find(route.signal)) {
    return Error{.kind = ErrorKind::unknown,
                 .detail = drive->name + " has no signal \"" + std::string(route.signal) + "\""};
  }
  if (parsed.members.has_error()) {
    return parsed.members.error();
  }
  const FlatObject& members = parsed.members.value();
  switch (route.kind) {
    case Route::Kind::nmt:
      return asked(nmt_command_of(members));
    case Route::Kind::sdo:
      return asked(sdo_request_of(members));
    case Route::Kind::set_drive:
      return Asked(fields_of(*drive, members));
    case Route::Kind::set_signal:  // carries one member, `value`
      return Asked(fields_of(*drive, {{std::string(route.signal), members.front().second}}));
    case Route::Kind::alive:
    case Route::Kind::stop_all:
    case Route::Kind::alarm:
    case Route::Kind::status:
    case Route::Kind::life:
      break;
  }
  return Error{.kind = ErrorKind::unknown, .detail = "nothing is asked for by this topic"};
}

bool asks_to_read(const Route& route, const Parsed& parsed) {
  if (route.kind != Route::Kind::sdo || parsed.members.has_error()) {
    return false;
  }
  const std::string* const op = text::find_string(parsed.members.value(), "op");
  return op != nullptr && *op == "read";
}

bool stops(const config::Drive& drive, const Asked& asked) {
  return std::holds_alternative<StopAll>(asked) || process::is_stop(drive, written_by(drive, asked));
}

}  // namespace mqtt
