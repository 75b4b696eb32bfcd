#include <optional>
#include <string>

#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"
#include "daemon/http/respond.h"

namespace gateway::http {
namespace {

constexpr std::string_view kLogType = "text/plain; charset=utf-8";

std::optional<std::string_view> name_or_null(const std::string& text) {
  return text.empty() ? std::nullopt : std::optional<std::string_view>(text);
}

void append_record(std::string& out, const recorder::StoredRecord& record) {
  const recorder::RecordSummary& summary = record.summary;
  const std::string& stem = record.stem;
  const bool has_json = record.json_size > 0;
  text::ObjectText object(out);
  object.text("name", stem + std::string(recorder::kLogSuffix));
  object.text("json", has_json ? std::optional<std::string>(stem + std::string(recorder::kJsonSuffix)) : std::nullopt);
  object.text("ts", text::timestamp(record.name.wall));
  object.text("bus", name_or_null(summary.bus));
  object.text("drive", name_or_null(summary.drive));
  object.text("kind", record.name.kind);
  object.boolean("first", summary.first);
  object.integer("size", static_cast<std::int64_t>(record.size()));
  object.integer("frames", static_cast<std::int64_t>(summary.frames));
  object.integer("commands", static_cast<std::int64_t>(summary.commands));
  object.close();
}

// Why there is nothing to show; nothing: there is.
std::optional<Answer> no_records(const Site& site) {
  if (!site.records) {
    return refusal(404, "nothing is recorded: the configuration has no [recorder], or no state_dir");
  }
  if (!site.records()) {
    return refusal(503, "the directory of the records cannot be read; the log says why");
  }
  return std::nullopt;
}

}  // namespace

Answer records(const Site& site) {
  if (auto none = no_records(site)) {
    return *std::move(none);
  }
  Answer answer;
  text::append_list(answer.body, site.records()->all(), append_record);
  return answer;
}

Answer record_file(const Site& site, std::string_view name) {
  if (auto none = no_records(site)) {
    return *std::move(none);
  }
  // Only a name that is listed: nothing that a client writes becomes a path.
  const bool is_log = name.ends_with(recorder::kLogSuffix);
  const std::string_view suffix = is_log ? recorder::kLogSuffix : recorder::kJsonSuffix;
  const recorder::StoredRecord* const record =
      name.ends_with(suffix) ? site.records()->find(name.substr(0, name.size() - suffix.size())) : nullptr;
  if (record != nullptr && (is_log || record->json_size > 0)) {
    const std::string file(name);
    return {
        .type = is_log ? kLogType : "application/json",
        .attachment = file,
        .file = FileBody{.size = is_log ? record->log_size : record->json_size,
                         .read = [read = site.read_record, file](std::uint64_t offset) { return read(file, offset); }}};
  }
  return refusal(404, "there is no record " + std::string(beginning(name)) + "; /api/records lists them");
}

}  // namespace gateway::http
