#include "bridges/journal/record_text.h"

#include <chrono>
#include <string_view>

#include "bridges/journal/json_text.h"
#include "bridges/process/answer.h"
#include "canopen/error.h"
#include "canopen/hex.h"
#include "canopen/nmt.h"

namespace journal {
namespace {

void append_field(std::string& out, const config::Signal& signal, const process::FieldRecord& field) {
  out += "{\"signal\":";
  append_text(out, signal.name);
  if (field.before) {
    append_value(out += ",\"before\":", signal, *field.before);
  }
  out += ",\"asked\":";
  if (field.asked) {
    append_value(out, signal, *field.asked);
  } else {
    append_given(out, field.given);
  }
  if (field.confirmed) {
    append_value(out += ",\"confirmed\":", signal, *field.confirmed);
  }
  out += '}';
}

void append_fields(std::string& out, const process::CommandRecord& record) {
  out += "\"fields\":[";
  for (const process::FieldRecord& field : record.fields) {
    if (&field != &record.fields.front()) {
      out += ',';
    }
    append_field(out, record.drive->signals.at(field.signal), field);
  }
  out += ']';
}

void append_object(std::string& out, const canopen::ObjectValue& value, const std::vector<std::uint8_t>& bytes) {
  out += "\"object\":\"" + canopen::to_string(value.object) + '"';
  if (bytes.empty()) {
    out += ",\"type\":\"";
    out += canopen::name_of(value.type);
    append_raw(out += "\",\"asked\":", value.type, value.raw);
    return;
  }
  out += ",\"bytes\":\"";
  for (const std::uint8_t byte : bytes) {
    out += canopen::hex(byte, 2);
  }
  out += '"';
}

}  // namespace

std::string who_text(const process::CommandRecord& record) {
  const process::Writer& writer = record.writer;
  const std::string& from = writer.way == process::Writer::Way::local ? writer.user : writer.address;
  std::string text = "\"writer\":\"" + std::string(name_of(writer.way)) + '"';
  if (!from.empty()) {
    append_text(text += ",\"from\":", from);
  }
  append_text(text += ",\"drive\":", record.drive->name);
  return text;
}

std::string what_text(const process::CommandRecord& record) {
  std::string text = "\"id\":";
  append_text(text, record.id);
  text += ',';
  switch (record.kind) {
    case process::CommandRecord::Kind::write:
      append_fields(text, record);
      break;
    case process::CommandRecord::Kind::nmt:
      text += "\"nmt\":";
      if (record.nmt) {
        append_text(text, canopen::name_of(*record.nmt));
      } else {
        text += "null";  // it was no command
      }
      break;
    case process::CommandRecord::Kind::raw:
      if (!record.object) {
        text += "\"object\":null";  // it was no request that can be carried out
        break;
      }
      append_object(text, *record.object, record.bytes);
      break;
  }
  return text;
}

std::string code_of(const process::Outcome& outcome) {
  return outcome.has_value() ? "ok" : std::string(process::answer_of(outcome.error().kind).mqtt_code);
}

std::string result_text(const process::CommandRecord& record, const process::Outcome& outcome, canopen::TimePoint now) {
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(now - record.arrived).count();
  std::string text = "\"ms\":" + std::to_string(ms);
  if (outcome.unchanged) {
    text += ",\"unchanged\":true";
  }
  if (outcome.has_error()) {
    if (outcome.written > 0) {
      text += ",\"written\":" + std::to_string(outcome.written);
    }
    if (outcome.error().abort != 0) {
      text += ",\"abort\":\"0x" + canopen::hex(outcome.error().abort, 8) + '"';
    }
    append_text(text += ",\"error\":", canopen::to_string(outcome.error()));
  }
  if (!outcome.note.empty()) {
    append_text(text += ",\"note\":", outcome.note);
  }
  return text;
}

}  // namespace journal
