#include "daemon/control/status_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <cstddef>
#include <vector>

namespace gateway::control {
namespace {

namespace json = boost::json;

constexpr std::size_t kCells = 9;
using Cells = std::array<std::string, kCells>;

const json::value* member(const json::object& object, std::string_view name) {
  return object.if_contains(json::string_view(name.data(), name.size()));
}

// A member for people: text as it is, yes and no, nothing for null and for what is not there.
std::string shown(const json::object& object, std::string_view name) {
  const json::value* const value = member(object, name);
  if (value == nullptr || value->is_null()) {
    return "";
  }
  if (const json::string* const text = value->if_string()) {
    return {text->data(), text->size()};
  }
  if (const bool* const truth = value->if_bool()) {
    return *truth ? "yes" : "no";
  }
  if (const double* const number = value->if_double()) {
    return fmt::format("{}", *number);
  }
  return json::serialize(*value);
}

template <class Show>
void for_each_object(const json::object& object, std::string_view name, Show show) {
  const json::value* const value = member(object, name);
  const json::array* const list = value == nullptr ? nullptr : value->if_array();
  if (list == nullptr) {
    return;
  }
  for (const json::value& each : *list) {
    if (const json::object* const entry = each.if_object()) {
      show(*entry);
    }
  }
}

// `control_command 1, frequency_command 40`
std::string pairs(const json::object& object, std::string_view name) {
  const json::value* const value = member(object, name);
  const json::object* const members = value == nullptr ? nullptr : value->if_object();
  std::string text;
  if (members != nullptr) {
    for (const auto& [key, unused] : *members) {
      const std::string_view signal(key.data(), key.size());
      text.append(text.empty() ? "" : ", ").append(signal).append(" ").append(shown(*members, signal));
    }
  }
  return text;
}

std::string holder_of(const json::object& drive) {
  const json::value* const control = member(drive, "control");
  const json::object* const members = control == nullptr ? nullptr : control->if_object();
  return members == nullptr ? "" : shown(*members, "holder");
}

std::string running(const json::object& drive) {
  const json::value* const values = member(drive, "values");
  const json::object* const members = values == nullptr ? nullptr : values->if_object();
  return members == nullptr ? "" : shown(*members, "running");
}

std::string with_unit(std::string text, std::string_view unit) {
  return text.empty() ? text : text.append(unit);
}

Cells cells_of(const json::object& drive, TableAges ages) {
  const bool online = shown(drive, "online") == "yes";
  const std::string away = shown(drive, "enabled") == "no" ? "not in service" : "offline";
  return {shown(drive, "name"),     shown(drive, "bus"),
          shown(drive, "node"),     online ? shown(drive, "nmt") : away,
          shown(drive, "boot"),     ages == TableAges::shown ? with_unit(shown(drive, "heartbeat_age"), " s") : "",
          shown(drive, "fresh"),    running(drive),
          pairs(drive, "commanded")};
}

std::string table(const std::vector<Cells>& rows) {
  std::string out;
  for (const Cells& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < kCells; ++i) {
      std::size_t width = 0;
      for (const Cells& other : rows) {
        width = std::max(width, other.at(i).size());
      }
      line += fmt::format("{:<{}}  ", row.at(i), width);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

// Of the drive with the least.
std::string margin_of(const json::object& bus) {
  const json::value* const value = member(bus, "heartbeat_margin");
  const json::object* const margin = value == nullptr ? nullptr : value->if_object();
  const json::value* const least = margin == nullptr ? nullptr : member(*margin, "least");
  if (least == nullptr || !least->is_number()) {
    return "";
  }
  constexpr double kPercent = 100;
  return fmt::format("  heartbeat margin {:.0f} % ({})", least->to_number<double>() * kPercent,
                     shown(*margin, "drive"));
}

std::string suspicion_line(const json::object& bus) {
  const std::string suspicion = shown(bus, "suspicion");
  return suspicion.empty() ? "" : fmt::format("bus {}  suspicion: {}\n", shown(bus, "name"), suspicion);
}

std::string bus_line(const json::object& bus, TableAges ages) {
  const std::string load = ages == TableAges::hidden ? std::string() : with_unit(shown(bus, "load"), " %");
  return fmt::format("bus {}  {}{}{}\n", shown(bus, "name"), shown(bus, "state"), load.empty() ? "" : "  load " + load,
                     margin_of(bus));
}

// What is wrong with a drive, a line each; who holds it, too.
std::string remarks(const json::object& drive) {
  std::string out;
  const std::string name = shown(drive, "name");
  if (const std::string text = shown(drive, "boot_text"); !text.empty()) {
    out += fmt::format("{}: boot: {}\n", name, text);
  }
  if (const std::string reload = shown(drive, "reload"); !reload.empty()) {
    out += fmt::format("{}: its new configuration {}\n", name, reload);
  }
  if (const std::string holder = holder_of(drive); !holder.empty()) {
    out += fmt::format("{}: held by {}\n", name, holder);
  }
  for_each_object(drive, "alarms", [&](const json::object& alarm) {
    const std::string reason = shown(alarm, "reason");
    const bool first = shown(alarm, "first") == "yes";
    out +=
        fmt::format("{}: alarm {}{}: {} {} (since {})\n", name, shown(alarm, "kind"), first ? ", first" : "",
                    reason.empty() ? shown(alarm, "code") : reason + ":", shown(alarm, "text"), shown(alarm, "since"));
  });
  return out;
}

}  // namespace

std::optional<std::string> status_table(std::string_view status, TableAges ages) {
  json::error_code failed;
  const json::value read = json::parse(json::string_view(status.data(), status.size()), failed);
  const json::object* const gateway = failed ? nullptr : read.if_object();
  if (gateway == nullptr) {
    return std::nullopt;
  }
  std::string out = fmt::format("gateway {} {}, up {} s\n", shown(*gateway, "gateway"), shown(*gateway, "version"),
                                ages == TableAges::shown ? shown(*gateway, "uptime") : "");
  for_each_object(*gateway, "buses",
                  [&](const json::object& bus) { out += bus_line(bus, ages) + suspicion_line(bus); });
  std::vector<Cells> rows{{"drive", "bus", "node", "state", "boot", "heartbeat", "fresh", "running", "commanded"}};
  std::string below;
  for_each_object(*gateway, "drives", [&](const json::object& drive) {
    rows.push_back(cells_of(drive, ages));
    below += remarks(drive);
  });
  return out + table(rows) + below;
}

std::string status_time(std::string_view status) {
  json::error_code failed;
  const json::value read = json::parse(json::string_view(status.data(), status.size()), failed);
  const json::object* const gateway = failed ? nullptr : read.if_object();
  return gateway == nullptr ? std::string() : shown(*gateway, "ts");
}

}  // namespace gateway::control
