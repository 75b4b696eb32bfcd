#include "daemon/control/ask.h"

#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "bridges/text/json_text.h"
#include "canopen/nmt.h"
#include "daemon/control/bus_table.h"
#include "daemon/control/exchange.h"
#include "daemon/control/find_daemon.h"
#include "daemon/control/order_text.h"
#include "daemon/control/status_table.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace gateway::control {
namespace {

namespace json = boost::json;

std::string text_member(const json::object& object, const char* name) {
  const json::value* const value = object.if_contains(name);
  const json::string* const text = value == nullptr ? nullptr : value->if_string();
  return text == nullptr ? std::string() : std::string(text->data(), text->size());
}

bool truth_member(const json::object& object, const char* name) {
  const json::value* const value = object.if_contains(name);
  const bool* const truth = value == nullptr ? nullptr : value->if_bool();
  return truth != nullptr && *truth;
}

/// What the daemon answered, where it is well.
struct Answer {
  int code = kFailed;
  std::string line;
  json::object members;
};

Answer ask(const Reach& reach, const std::string& request) {
  const std::optional<Daemon> daemon = find_daemon(reach);
  if (!daemon) {
    return {.code = kConfigurationError, .line = {}, .members = {}};
  }
  if (daemon->socket.empty()) {
    complain("[gateway] control is empty: this gateway has no control socket");
    return {};
  }
  Exchanged exchanged = exchange(daemon->socket, request, daemon->patience);
  if (!exchanged.problem.empty()) {
    complain(exchanged.problem);
    return {};
  }
  json::error_code failed;
  json::value read = json::parse(exchanged.answer, failed);
  if (failed || !read.is_object()) {
    complain("what listens at " + daemon->socket.string() + " is no gateway: it answers \"" +
             exchanged.answer.substr(0, 80) + "\"");
    return {};
  }
  if (!truth_member(read.as_object(), "ok")) {
    const std::string code = text_member(read.as_object(), "code");
    const std::string error = text_member(read.as_object(), "error");
    complain(error.starts_with(code) ? error : code + ": " + error);
    return {};
  }
  return {.code = kDone, .line = std::move(exchanged.answer), .members = std::move(read.as_object())};
}

// The last member as it was written: a parser would not keep its digits. Empty where it is another.
std::string last_member(std::string_view line, std::string_view name) {
  const std::string before = R"({"id":1,"ok":true,")" + std::string(name) + "\":";
  return line.starts_with(before) ? std::string(line.substr(before.size(), line.size() - before.size() - 1)) : "";
}

// Prints what was asked for.
int show(const Answer& answer, const std::string& text) {
  if (answer.code == kDone && text.empty()) {
    complain("the gateway answers what this program does not know: they are of different versions");
    return kFailed;
  }
  if (answer.code == kDone) {
    print(text);
  }
  return answer.code;
}

// The answer is told by one word, and what is beside it.
int command(const Reach& reach, const std::string& request) {
  const Answer answer = ask(reach, request);
  if (answer.code != kDone) {
    return answer.code;
  }
  std::string told = truth_member(answer.members, "unchanged") ? "ok, unchanged" : "ok";
  if (const std::string note = text_member(answer.members, "note"); !note.empty()) {
    told += ": " + note;
  }
  print(told + "\n");
  return kDone;
}

std::string request_of(std::string_view op, const std::string& drive,
                       const std::vector<std::pair<std::string_view, std::string>>& members) {
  std::string out;
  text::ObjectText object(out);
  object.integer("id", 1);  // the only one of its connection
  object.text("op", op);
  if (!drive.empty()) {
    object.text("drive", drive);
  }
  for (const auto& [name, value] : members) {
    object.key(name) += value;
  }
  object.close();
  return out;
}

std::string as_json(std::string_view text) {
  std::string out;
  text::append_quoted(out, text);
  return out;
}

}  // namespace

int set(const Reach& reach, const std::string& drive, const std::vector<std::string>& assignments) {
  const std::optional<std::string> values = values_of(assignments);
  if (!values) {
    complain("set DRIVE SIGNAL=VALUE...: a value is given as frequency_command=30.0");
    return kUsage;
  }
  return command(reach, request_of("set", drive, {{"values", *values}}));
}

int nmt(const Reach& reach, const std::string& drive, const std::string& command_name) {
  if (!canopen::parse_nmt_command(command_name)) {
    complain("nmt DRIVE COMMAND: COMMAND is start, stop, pre-operational, reset-node or reset-communication, not \"" +
             command_name + "\"");
    return kUsage;
  }
  return command(reach, request_of("nmt", drive, {{"command", as_json(command_name)}}));
}

int sdo(const Reach& reach, const SdoOrder& order) {
  const bool writes = order.way == SdoOrder::Way::write;
  const std::size_t least = writes ? 1 : 0;
  if (order.words.size() < least || order.words.size() > least + 1) {
    complain(writes ? "sdo write DRIVE INDEX:SUB [TYPE] VALUE" : "sdo read DRIVE INDEX:SUB [TYPE]");
    return kUsage;
  }
  std::vector<std::pair<std::string_view, std::string>> members{{"object", as_json(order.object)}};
  if (order.words.size() > least) {
    members.emplace_back("type", as_json(order.words.front()));
  }
  if (writes) {
    const bool is_text =
        order.words.size() > least && (order.words.front() == "string" || order.words.front() == "bytes");
    members.emplace_back("value", is_text ? as_json(order.words.back()) : json_of_raw(order.words.back()));
    return command(reach, request_of("sdo-write", order.drive, members));
  }
  const Answer answer = ask(reach, request_of("sdo-read", order.drive, members));
  const std::string value = last_member(answer.line, "value");
  return show(answer, value.empty() ? value : value + "\n");
}

int status(const Reach& reach, bool wants_json) {
  const Answer answer = ask(reach, request_of("status", {}, {}));
  const std::string told = last_member(answer.line, "status");
  return show(answer, wants_json && !told.empty() ? told + "\n" : status_table(told).value_or(""));
}

int buses(const Reach& reach, bool wants_json) {
  const Answer answer = ask(reach, request_of("buses", {}, {}));
  const std::string told = last_member(answer.line, "buses");
  return show(answer, wants_json && !told.empty() ? told + "\n" : bus_table(told).value_or(""));
}

int record(const Reach& reach, const std::string& drive, const std::string& bus) {
  if (drive.empty() == bus.empty()) {
    complain("record DRIVE, or record --bus BUS");
    return kUsage;
  }
  std::vector<std::pair<std::string_view, std::string>> members;
  if (!bus.empty()) {
    members.emplace_back("bus", as_json(bus));
  }
  const Answer answer = ask(reach, request_of("record", drive, members));
  std::string told = text_member(answer.members, "record");
  const json::value* const remaining = answer.members.if_contains("remaining_ms");
  if (!told.empty() && remaining != nullptr && remaining->is_int64()) {
    told += truth_member(answer.members, "under_way") ? ": under way already," : ":";
    told += " whole in " + std::to_string((remaining->get_int64() + 999) / 1000) + " s\n";
  }
  return show(answer, told);
}

int stop(const Reach& reach) {
  return command(reach, request_of("stop", {}, {}));
}

}  // namespace gateway::control
