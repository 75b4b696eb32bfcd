// `trace` of the running gateway.

#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <string>

#include "bridges/text/json_text.h"
#include "bridges/trace/line.h"
#include "daemon/control/ask.h"
#include "daemon/control/follow.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"

namespace gateway::control {
namespace {

namespace json = boost::json;

std::string member_text(const json::object& members, const char* name) {
  const json::value* const value = members.if_contains(name);
  const json::string* const text = value == nullptr ? nullptr : value->if_string();
  return text == nullptr ? std::string() : std::string(text->data(), text->size());
}

std::int64_t member_count(const json::object& members, const char* name) {
  const json::value* const value = members.if_contains(name);
  const std::int64_t* const count = value == nullptr ? nullptr : value->if_int64();
  return count == nullptr ? 0 : *count;
}

std::string trace_request(const trace::FilterWords& filter, bool raw) {
  std::string out;
  text::ObjectText object(out);
  object.integer("id", 1);
  object.text("op", "trace");
  object.text("names", filter.names);
  object.text("kinds", filter.kinds);
  object.text("cob_ids", filter.cob_ids);
  object.boolean("raw", raw);
  object.close();
  return out;
}

void show_line(std::string_view line) {
  json::error_code failed;
  const json::value read = json::parse(json::string_view(line.data(), line.size()), failed);
  const json::object* const members = failed ? nullptr : read.if_object();
  if (members == nullptr) {
    return;
  }
  // Not among the frames: what reads them from a pipe takes nothing else.
  if (const std::int64_t lost = member_count(*members, "lost"); lost > 0) {
    complain("up to " + std::to_string(lost) + " frames are not shown here: they came faster than they were taken");
    return;
  }
  if (const std::int64_t lost = member_count(*members, "lost_frames"); lost > 0) {
    complain(member_text(*members, "bus") + ": at least " + std::to_string(lost) +
             " frames were lost here, in the controller or between it and the gateway");
    return;
  }
  if (members->contains("raw")) {
    print(member_text(*members, "raw") + "\n");
    return;
  }
  const json::value* const own = members->if_contains("own");
  print(trace::terminal_line({.time = member_text(*members, "ts"),
                              .bus = member_text(*members, "bus"),
                              .frame = member_text(*members, "frame"),
                              .own = own != nullptr && own->is_bool() && own->as_bool(),
                              .kind = member_text(*members, "kind"),
                              .owner = member_text(*members, "owner"),
                              .name = member_text(*members, "name"),
                              .text = member_text(*members, "text")}) +
        "\n");
}

}  // namespace

int trace(const Reach& reach, const trace::FilterWords& filter, bool raw) {
  return follow_stream(reach, trace_request(filter, raw), show_line);
}

}  // namespace gateway::control
