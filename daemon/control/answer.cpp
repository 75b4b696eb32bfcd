#include "daemon/control/answer.h"

#include <utility>

#include "bridges/mqtt/answers.h"
#include "bridges/text/json_text.h"

namespace gateway::control {
namespace {

text::ObjectText begin_answer(std::string& out, std::string_view id) {
  text::ObjectText object(out);
  object.key("id") += id;
  object.boolean("ok", true);
  return object;
}

// The name of a command in journal and log, at the end of its answer.
std::string with_command(std::string answer, const std::string& command) {
  if (!command.empty()) {
    answer.back() = ',';
    text::append_quoted(answer, "command");
    answer += ':';
    text::append_quoted(answer, command);
    answer += '}';
  }
  return answer;
}

std::string told(std::string_view id, std::string_view name, std::string_view json) {
  std::string out;
  text::ObjectText object = begin_answer(out, id);
  object.key(name) += json;
  object.close();
  return out;
}

}  // namespace

std::string refusal(std::string_view id, const canopen::Error& error) {
  return mqtt::sdo_answer({.id = std::string(id)}, error, canopen::DataType::u8).payload;
}

std::string told_outcome(std::string_view id, const process::Outcome& outcome) {
  if (outcome.has_error()) {
    return with_command(refusal(id, outcome.error()), outcome.id);
  }
  std::string out;
  text::ObjectText object = begin_answer(out, id);
  if (outcome.unchanged) {
    object.boolean("unchanged", true);
  }
  if (!outcome.note.empty()) {
    object.text("note", outcome.note);
  }
  object.close();
  return with_command(std::move(out), outcome.id);
}

std::string read_value(std::string_view id, canopen::DataType type, canopen::Raw raw) {
  return mqtt::sdo_answer({.id = std::string(id)}, raw, type).payload;
}

std::string read_data(std::string_view id, mqtt::SdoForm form, const std::vector<std::uint8_t>& data) {
  return mqtt::sdo_answer({.id = std::string(id)}, data, form).payload;
}

std::string stop_answer(std::string_view id, std::size_t asked, std::span<const process::NotStopped> not_stopped) {
  if (asked == 0) {
    return refusal(id, {.kind = canopen::ErrorKind::forbidden,
                        .detail = "no drive takes commands of the command line: none names \"local\" in writers"});
  }
  if (not_stopped.empty()) {
    std::string out;
    text::ObjectText object = begin_answer(out, id);
    object.integer("stopped", static_cast<std::int64_t>(asked));
    object.close();
    return out;
  }
  std::string names;
  for (const process::NotStopped& each : not_stopped) {
    names.append(names.empty() ? "" : "; ").append(each.name).append(": ");
    names += canopen::to_string(each.error);
  }
  return refusal(id, {.kind = not_stopped.front().error.kind, .detail = "not confirmed by all: " + names});
}

std::string told_status(std::string_view id, std::string_view status) {
  return told(id, "status", status);
}

std::string told_buses(std::string_view id, std::string_view buses) {
  return told(id, "buses", buses);
}

}  // namespace gateway::control
