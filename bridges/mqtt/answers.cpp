#include "bridges/mqtt/answers.h"

#include "bridges/mqtt/value_text.h"
#include "bridges/process/answer.h"
#include "bridges/text/json_text.h"
#include "canopen/hex.h"
#include "canopen/object.h"

namespace mqtt {
namespace {

// The detail alone where it says all; an abort code and a doubtful outcome are always named.
std::string text_of(const canopen::Error& error) {
  const bool plain = !error.detail.empty() && error.abort == 0 && !error.outcome_unknown;
  return plain ? error.detail : canopen::to_string(error);
}

void append_error(text::ObjectText& object, const canopen::Error& error) {
  object.text("code", process::answer_of(error.kind).mqtt_code);
  if (error.abort != 0) {
    object.text("abort", "0x" + canopen::hex(error.abort, 8));
  }
  object.text("error", text_of(error));
}

// The client's own id as he wrote it, else the one by which the journal knows the command.
void append_id(text::ObjectText& object, const ReplyTo& to, std::string_view made = {}) {
  if (!to.id.empty()) {
    object.key("id") += to.id;
  } else if (!made.empty()) {
    object.text("id", made);
  }
}

void append_outcome(text::ObjectText& object, const process::Outcome& outcome) {
  object.boolean("ok", outcome.has_value());
  if (outcome.has_error()) {
    append_error(object, outcome.error());
  }
}

// Both forms have the same members, each in an order of its own.
std::string answer_text(const ReplyTo& to, const process::Outcome& outcome, const std::optional<std::string>& first) {
  std::string payload;
  text::ObjectText object(payload);
  if (to.sdo) {
    append_id(object, to, outcome.id);
  }
  append_outcome(object, outcome);
  if (first) {
    object.key("first") += *first;
  }
  if (!to.sdo) {
    object.text("topic", to.command_topic);
    append_id(object, to, outcome.id);
  }
  if (outcome.unchanged) {
    object.boolean("unchanged", true);
  }
  if (!outcome.note.empty()) {
    object.text("note", outcome.note);
  }
  object.close();
  return payload;
}

void append_raw(text::ObjectText& object, canopen::DataType type, canopen::Raw raw) {
  if (type == canopen::DataType::boolean) {
    object.boolean("value", raw != 0);
  } else if (canopen::is_real(type)) {
    object.number("value", canopen::to_number(type, raw));
  } else {
    object.key("value") += integer_text(type, raw);
  }
}

Message answer(const ReplyTo& to, std::string payload) {
  return {.topic = to.topic,
          .payload = std::move(payload),
          .kind = MessageKind::answer,
          .retained = false,
          .correlation = to.correlation};
}

}  // namespace

Message command_answer(const ReplyTo& to, const process::Outcome& outcome) {
  return answer(to, answer_text(to, outcome, std::nullopt));
}

std::string first_outcome(const process::Outcome& outcome) {
  std::string text;
  text::ObjectText object(text);
  append_outcome(object, outcome);
  object.close();
  return text;
}

canopen::Error duplicate_error() {
  return {.kind = canopen::ErrorKind::duplicate, .detail = "the same command came within the last 60 s"};
}

Message duplicate_answer(const ReplyTo& to, const std::optional<std::string>& first) {
  return answer(to, answer_text(to, duplicate_error(), first));
}

Message sdo_answer(const ReplyTo& to, const canopen::Result<canopen::Raw>& read, canopen::DataType type) {
  std::string payload;
  text::ObjectText object(payload);
  append_id(object, to);
  object.boolean("ok", read.has_value());
  if (read.has_error()) {
    append_error(object, read.error());
  } else {
    append_raw(object, type, read.value());
  }
  object.close();
  return answer(to, std::move(payload));
}

Message sdo_answer(const ReplyTo& to, const canopen::Result<std::vector<std::uint8_t>>& read, SdoForm form) {
  std::string payload;
  text::ObjectText object(payload);
  append_id(object, to);
  object.boolean("ok", read.has_value());
  if (read.has_error()) {
    append_error(object, read.error());
  } else {
    object.text("value", sdo_text(form, read.value()));
  }
  object.close();
  return answer(to, std::move(payload));
}

}  // namespace mqtt
