#include "bridges/recorder/record_text.h"

#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>

#include "bridges/alarms/alarm_json.h"
#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"

namespace recorder {
namespace {

namespace json = boost::json;

constexpr int kVersion = 1;

std::optional<std::string_view> or_null(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional<std::string_view>(text);
}

void append_recorded_alarm(std::string& out, const RecordedAlarm& one) {
  text::ObjectText object(out);
  if (one.kind) {
    object.text("drive", one.drive);
  }
  object.text("kind", one.kind ? alarms::name_of(*one.kind) : "bus");
  object.key("alarm") += alarms::alarm_json(one.alarm);
  object.key("at_end") += alarms::alarm_json(one.at_end);
  object.close();
}

void append_gap(std::string& out, const LogFigures::Gap& gap) {
  text::ObjectText object(out);
  object.text("ts", text::timestamp(gap.wall));
  object.integer("frames", gap.frames);
  object.close();
}

std::optional<std::string> string_member(const json::object& object, json::string_view name) {
  const json::value* const value = object.if_contains(name);
  const json::string* const text = value == nullptr ? nullptr : value->if_string();
  return text == nullptr ? std::nullopt : std::optional(std::string(text->data(), text->size()));
}

bool is_name(const std::string& text) {
  return parse_record_name("20260102T030405.678Z-" + text + "-bus").has_value();
}

}  // namespace

std::string record_json(const Record& record, const LogFigures& log) {
  std::string out;
  text::ObjectText object(out);
  object.integer("version", kVersion);
  object.text("name", to_text(record.name) + std::string(kLogSuffix));
  object.text("kind", record.name.kind);
  object.text("bus", record.bus);
  object.text("interface", record.interface);
  object.integer("bitrate", record.bitrate);
  object.text("drive", or_null(record.drive));
  object.text("requested_by", or_null(record.requested_by));
  object.text("ts", text::timestamp(record.name.wall));
  object.text("from", text::timestamp(record.from));
  object.text("until", text::timestamp(record.until));
  object.boolean("first", record.first());
  object.integer("frames", static_cast<std::int64_t>(log.frames));
  object.integer("error_frames", static_cast<std::int64_t>(log.error_frames));
  object.integer("frames_lost", static_cast<std::int64_t>(log.lost));
  text::append_list(object.key("gaps"), log.gaps, append_gap);
  object.boolean("begin_missing", record.frames.cut);
  object.boolean("shortened", log.shortened);
  object.text("ended", or_null(record.ended));
  text::append_list(object.key("alarms"), record.alarms, append_recorded_alarm);
  object.integer("alarms_left_out", static_cast<std::int64_t>(record.alarms_left_out));
  text::append_list(object.key("commands"), record.commands,
                    [](std::string& to, const std::string& command) { to += '\n' + command; });
  object.integer("commands_left_out", static_cast<std::int64_t>(record.commands_left_out));
  object.close();
  return out += '\n';
}

std::optional<RecordSummary> parse_summary(std::string_view text) {
  json::error_code failure;
  const json::value value = json::parse(json::string_view(text.data(), text.size()), failure);
  const json::object* const object = failure ? nullptr : value.if_object();
  const json::value* const version = object == nullptr ? nullptr : object->if_contains("version");
  if (version == nullptr || *version != kVersion) {
    return std::nullopt;
  }
  RecordSummary summary;
  summary.bus = string_member(*object, "bus").value_or("");
  summary.drive = string_member(*object, "drive").value_or("");
  if (!is_name(summary.bus) || (!summary.drive.empty() && !is_name(summary.drive))) {
    return std::nullopt;
  }
  const json::value* const first = object->if_contains("first");
  summary.first = first != nullptr && first->is_bool() && first->get_bool();
  const json::value* const frames = object->if_contains("frames");
  json::error_code no_number;
  summary.frames = frames != nullptr && frames->is_number() ? frames->to_number<std::uint64_t>(no_number) : 0;
  const json::value* const commands = object->if_contains("commands");
  summary.commands = commands != nullptr && commands->is_array() ? commands->get_array().size() : 0;
  return summary;
}

}  // namespace recorder
