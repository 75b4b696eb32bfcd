#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>

#include "daemon/compare/compare.h"

namespace gateway::compare {
namespace {

namespace json = boost::json;

const json::value* member_of(const json::object& object, const char* name) {
  return object.if_contains(name);
}

std::string string_of(const json::object& object, const char* name) {
  const json::value* const value = member_of(object, name);
  const json::string* const text = value == nullptr ? nullptr : value->if_string();
  return text == nullptr ? std::string() : std::string(text->data(), text->size());
}

bool bool_of(const json::object& object, const char* name) {
  const json::value* const value = member_of(object, name);
  return value != nullptr && value->is_bool() && value->get_bool();
}

double double_of(const json::object& object, const char* name) {
  const json::value* const value = member_of(object, name);
  json::error_code wrong;
  const double number = value == nullptr ? 0.0 : value->to_number<double>(wrong);
  return wrong ? 0.0 : number;
}

// 0 where it is none.
std::int64_t integer_of(const json::object& object, const char* name) {
  const json::value* const value = member_of(object, name);
  json::error_code wrong;
  const auto number = value == nullptr ? 0 : value->to_number<std::int64_t>(wrong);
  return wrong ? 0 : number;
}

RunningDrive drive_of(const json::object& told) {
  return {.name = string_of(told, "name"),
          .bus = string_of(told, "bus"),
          .node = integer_of(told, "node"),
          .profile = string_of(told, "profile"),
          .enabled = bool_of(told, "enabled"),
          .online = bool_of(told, "online"),
          .nmt = string_of(told, "nmt"),
          .boot = string_of(told, "boot"),
          .boot_text = string_of(told, "boot_text")};
}

}  // namespace

std::optional<Running> read_running(std::string_view answer) {
  json::error_code wrong;
  const json::value read = json::parse(json::string_view(answer.data(), answer.size()), wrong);
  const json::value* const status = wrong || !read.is_object() ? nullptr : member_of(read.as_object(), "status");
  if (status == nullptr || !status->is_object()) {
    return std::nullopt;
  }
  const json::object& told = status->as_object();
  const json::value* const drives = member_of(told, "drives");
  if (drives == nullptr || !drives->is_array()) {
    return std::nullopt;
  }
  Running running{.gateway = string_of(told, "gateway"), .uptime = double_of(told, "uptime"), .drives = {}};
  for (const json::value& drive : drives->as_array()) {
    if (drive.is_object()) {
      running.drives.push_back(drive_of(drive.as_object()));
    }
  }
  return running;
}

}  // namespace gateway::compare
