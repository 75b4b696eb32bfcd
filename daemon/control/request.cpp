#include "daemon/control/request.h"

#include <algorithm>
#include <array>
#include <span>
#include <utility>

namespace gateway::control {
namespace {

using canopen::Error;
using canopen::ErrorKind;
using text::FlatObject;
using text::Scalar;

constexpr std::string_view kValues = "values";

struct OpNames {
  Op op;
  std::string_view name;
  std::span<const std::string_view> members;  ///< Besides `id` and `op`.
};

constexpr std::array<std::string_view, 2> kOfSet{"drive", kValues};
constexpr std::array<std::string_view, 2> kOfNmt{"drive", "command"};
constexpr std::array<std::string_view, 3> kOfRead{"drive", "object", "type"};
constexpr std::array<std::string_view, 4> kOfWrite{"drive", "object", "type", "value"};
constexpr std::array<std::string_view, 1> kOfStatus{"watch"};
constexpr std::array<std::string_view, 4> kOfTrace{"names", "kinds", "cob_ids", "raw"};
constexpr std::array<std::string_view, 2> kOfRecord{"drive", "bus"};
constexpr std::array<OpNames, 9> kOps{{{Op::set, "set", kOfSet},
                                       {Op::nmt, "nmt", kOfNmt},
                                       {Op::sdo_read, "sdo-read", kOfRead},
                                       {Op::sdo_write, "sdo-write", kOfWrite},
                                       {Op::status, "status", kOfStatus},
                                       {Op::stop, "stop", {}},
                                       {Op::trace, "trace", kOfTrace},
                                       {Op::buses, "buses", {}},
                                       {Op::record, "record", kOfRecord}}};

Error no_request(std::string detail) {
  return {.kind = ErrorKind::type, .detail = std::move(detail)};
}

std::optional<Error> refuse_members(const FlatObject& members, bool has_values, const OpNames& op) {
  const auto knows = [&op](std::string_view name) { return std::ranges::find(op.members, name) != op.members.end(); };
  std::string unknown = has_values && !knows(kValues) ? std::string(kValues) : std::string();
  for (const auto& [name, value] : members) {
    if (name != "id" && name != "op" && !knows(name)) {
      unknown = name;
    }
  }
  if (unknown.empty()) {
    return std::nullopt;
  }
  std::string known = "id, op";
  for (const std::string_view name : op.members) {
    known.append(", ").append(name);
  }
  return no_request("unknown member \"" + unknown + "\"; of \"" + std::string(op.name) + "\" there are " + known);
}

// Fills `text` from a member that has to be a string.
std::optional<Error> take_text(const FlatObject& members, std::string_view name, std::string& text) {
  const Scalar* const value = text::find_member(members, name);
  if (value == nullptr) {
    return no_request("\"" + std::string(name) + "\" is missing");
  }
  if (value->kind != Scalar::Kind::string) {
    return no_request("\"" + std::string(name) + "\" is to be a string");
  }
  text = value->text;
  return std::nullopt;
}

// The same of one that may be left out.
std::optional<Error> take_optional_text(const FlatObject& members, std::string_view name, std::string& text) {
  return text::find_member(members, name) == nullptr ? std::nullopt : take_text(members, name, text);
}

std::optional<Error> take_optional_truth(const FlatObject& members, std::string_view name, bool& truth) {
  const Scalar* const value = text::find_member(members, name);
  if (value == nullptr) {
    return std::nullopt;
  }
  if (value->kind != Scalar::Kind::boolean) {
    return no_request("\"" + std::string(name) + "\" is to be true or false");
  }
  truth = value->text == "true";
  return std::nullopt;
}

std::optional<Error> take_trace(const FlatObject& members, Request& request) {
  if (auto refused = take_optional_text(members, "names", request.names)) {
    return refused;
  }
  if (auto refused = take_optional_text(members, "kinds", request.kinds)) {
    return refused;
  }
  if (auto refused = take_optional_text(members, "cob_ids", request.cob_ids)) {
    return refused;
  }
  return take_optional_truth(members, "raw", request.raw);
}

std::optional<Error> take_sdo(const FlatObject& members, Request& request) {
  if (auto refused = take_text(members, "object", request.object)) {
    return refused;
  }
  if (text::find_member(members, "type") != nullptr) {
    if (auto refused = take_text(members, "type", request.type.emplace())) {
      return refused;
    }
  }
  if (request.op == Op::sdo_read) {
    return std::nullopt;
  }
  const Scalar* const value = text::find_member(members, "value");
  if (value == nullptr) {
    return no_request("\"value\" is missing");
  }
  request.value = *value;
  return std::nullopt;
}

// A record is of a drive, or of all of a bus.
std::optional<Error> take_subject(const FlatObject& members, Request& request) {
  const bool has_drive = text::find_member(members, "drive") != nullptr;
  if (has_drive == (text::find_member(members, "bus") != nullptr)) {
    return no_request("\"record\" is of a \"drive\" or of a \"bus\"");
  }
  return has_drive ? take_text(members, "drive", request.drive) : take_text(members, "bus", request.bus);
}

std::optional<Error> take_members(text::NestedObject& read, Request& request) {
  if (request.op == Op::status) {
    return take_optional_truth(read.members, "watch", request.watch);
  }
  if (request.op == Op::trace) {
    return take_trace(read.members, request);
  }
  if (request.op == Op::stop || request.op == Op::buses) {
    return std::nullopt;
  }
  if (request.op == Op::record) {
    return take_subject(read.members, request);
  }
  if (auto refused = take_text(read.members, "drive", request.drive)) {
    return refused;
  }
  if (request.op == Op::nmt) {
    return take_text(read.members, "command", request.command);
  }
  if (request.op != Op::set) {
    return take_sdo(read.members, request);
  }
  if (!read.inner) {
    return no_request("\"values\" is to be an object of signals and their values");
  }
  request.values = std::move(*read.inner);
  return std::nullopt;
}

canopen::Result<Request> request_of(text::NestedObject& read) {
  std::string name;
  if (const auto refused = take_text(read.members, "op", name)) {
    return *refused;
  }
  const auto* const op = std::ranges::find(kOps, std::string_view(name), &OpNames::name);
  if (op == kOps.end()) {
    return Error{
        .kind = ErrorKind::unknown,
        .detail = "no such \"op\"; there are set, nmt, sdo-read, sdo-write, status, stop, trace, buses, record"};
  }
  if (const auto refused = refuse_members(read.members, read.inner.has_value(), *op)) {
    return *refused;
  }
  Request request{.op = op->op};
  if (const auto refused = take_members(read, request)) {
    return *refused;
  }
  return request;
}

}  // namespace

Line parse_line(std::string_view text) {
  canopen::Result<text::NestedObject> read = text::parse_nested(text, kValues);
  if (read.has_error()) {
    return {.request = read.error()};
  }
  Line line{.request = Request{}};
  if (const Scalar* const id = text::find_member(read.value().members, "id")) {
    const std::optional<std::string> echoed = text::echoed_id(*id);
    if (!echoed) {
      line.request = no_request("\"id\" is to be a string or a number");
      return line;
    }
    line.id = *echoed;
  }
  line.request = request_of(read.value());
  return line;
}

Error too_long() {
  return no_request("the line is longer than " + std::to_string(kMaxLine) + " bytes");
}

}  // namespace gateway::control
