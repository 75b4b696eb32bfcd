#include "tests/rooms/include_rules.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <optional>
#include <span>
#include <sstream>

namespace rooms {
namespace {

using Headers = std::span<const std::string_view>;

/// A room and what of other rooms it may include: a header, or a whole folder with a slash at its end.
struct Room {
  std::string_view folder;
  Headers allowed;
};

// Plain values: what a profile says about a node, how it is named, and how long a frame is.
constexpr std::array<std::string_view, 8> kConfig{
    "canopen/clock.h",         "canopen/bus/echo.h",           "canopen/node/emcy.h",
    "canopen/error.h",         "canopen/node/node_settings.h", "canopen/object.h",
    "canopen/bus/wire_bits.h", "canopen/node/life_guarding.h"};
// A thread that waits for the disk, and how times and texts are written and read: they know nothing of the field.
constexpr std::array<std::string_view, 1> kDisk{"canopen/clock.h"};
constexpr std::array<std::string_view, 3> kText{"canopen/clock.h", "canopen/error.h", "canopen/hex.h"};
// Listening on TCP, for whatever protocol.
constexpr std::array<std::string_view, 2> kNet{"canopen/clock.h", "config/model.h"};
// Which errors are active and what they are called: plain values in and out. What is kept of them waits for a disk.
constexpr std::array<std::string_view, 10> kAlarms{
    "bridges/disk/",          "canopen/event.h", "canopen/wake_up.h",
    "bridges/text/",          "config/model.h",  "canopen/clock.h",
    "canopen/node/emcy.h",    "canopen/hex.h",   "canopen/node/node_events.h",
    "canopen/bus/bus_state.h"};
// The remote drive, what its interface is made of, and how a coroutine waits; never frames or links.
constexpr std::array<std::string_view, 19> kProcess{"bridges/text/",
                                                    "bridges/alarms/",
                                                    "config/model.h",
                                                    "config/text.h",
                                                    "config/value_check.h",
                                                    "canopen/communication_objects.h",
                                                    "canopen/node/remote_node.h",
                                                    "canopen/node/node_events.h",
                                                    "canopen/node/node_settings.h",
                                                    "canopen/sdo/stop_limit.h",
                                                    "canopen/object.h",
                                                    "canopen/error.h",
                                                    "canopen/clock.h",
                                                    "canopen/bus/bus_state.h",
                                                    "canopen/nmt.h",
                                                    "canopen/node/emcy.h",
                                                    "canopen/event.h",
                                                    "canopen/wake_up.h",
                                                    "canopen/hex.h"};
constexpr std::array<std::string_view, 10> kModbus{
    "config/address_map.h", "bridges/net/",    "bridges/text/",   "bridges/alarms/",  "bridges/process/",
    "config/model.h",       "canopen/clock.h", "canopen/error.h", "canopen/object.h", "canopen/hex.h"};
constexpr std::array<std::string_view, 9> kMqtt{"config/address_map.h", "bridges/text/",    "bridges/alarms/",
                                                "bridges/process/",     "config/model.h",   "canopen/clock.h",
                                                "canopen/error.h",      "canopen/object.h", "canopen/hex.h"};
// What is commanded, as `bridges/process` hands it over, and how it waits.
constexpr std::array<std::string_view, 11> kJournal{
    "bridges/disk/",   "bridges/text/", "bridges/process/", "config/model.h",   "canopen/clock.h",  "canopen/error.h",
    "canopen/event.h", "canopen/hex.h", "canopen/nmt.h",    "canopen/object.h", "canopen/wake_up.h"};
// Frames as they are seen, what the model says of them, and how values are written for people.
constexpr std::array<std::string_view, 20> kTrace{"bridges/text/",
                                                  "bridges/alarms/fault_naming.h",
                                                  "bridges/mqtt/value_text.h",
                                                  "config/log_interface.h",
                                                  "config/model.h",
                                                  "canopen/bus/bus.h",
                                                  "canopen/bus/frame_tap.h",
                                                  "canopen/clock.h",
                                                  "canopen/cob_id.h",
                                                  "canopen/communication_objects.h",
                                                  "canopen/error.h",
                                                  "canopen/frame.h",
                                                  "canopen/hex.h",
                                                  "canopen/nmt.h",
                                                  "canopen/node/emcy.h",
                                                  "canopen/node/error_report.h",
                                                  "canopen/node/node_settings.h",
                                                  "canopen/node/pdo.h",
                                                  "canopen/object.h",
                                                  "canopen/sdo/frames.h"};
// Frames as a tap sees them; faults and commands as `bridges/process` tells of them, worded as in the journal.
constexpr std::array<std::string_view, 13> kRecorder{
    "bridges/disk/",          "bridges/text/",          "bridges/alarms/",
    "bridges/process/",       "config/log_interface.h", "config/model.h",
    "canopen/clock.h",        "canopen/bus/link.h",     "bridges/journal/record_text.h",
    "canopen/error.h",        "canopen/event.h",        "canopen/wake_up.h",
    "canopen/bus/frame_tap.h"};
// Frames and links, but nothing that knows a service: the simulator is the master's independent counterpart.
constexpr std::array<std::string_view, 6> kSimulator{"canopen/bus/bus_state.h",
                                                     "canopen/clock.h",
                                                     "canopen/frame.h",
                                                     "canopen/bus/link.h",
                                                     "canopen/bus/virtual_link.h",
                                                     "canopen/bus/socketcan/socketcan_link.h"};
// The only one that knows the loader.
constexpr std::array<std::string_view, 13> kDaemon{
    "bridges/disk/",     "canopen/",         "config/",         "bridges/text/", "bridges/net/",
    "bridges/alarms/",   "bridges/process/", "bridges/modbus/", "bridges/mqtt/", "bridges/journal/",
    "bridges/recorder/", "bridges/trace/",   "simulator/"};

constexpr std::array<Room, 14> kRooms{{{"canopen/", {}},
                                       {"config/", kConfig},
                                       {"bridges/disk/", kDisk},
                                       {"bridges/text/", kText},
                                       {"bridges/net/", kNet},
                                       {"bridges/alarms/", kAlarms},
                                       {"bridges/process/", kProcess},
                                       {"bridges/modbus/", kModbus},
                                       {"bridges/mqtt/", kMqtt},
                                       {"bridges/journal/", kJournal},
                                       {"bridges/trace/", kTrace},
                                       {"bridges/recorder/", kRecorder},
                                       {"simulator/", kSimulator},
                                       {"daemon/", kDaemon}}};

const Room* room_of(std::string_view path) {
  const auto* const room =
      std::find_if(kRooms.begin(), kRooms.end(), [&](const Room& each) { return path.starts_with(each.folder); });
  return room == kRooms.end() ? nullptr : room;
}

bool allows(const Room& room, std::string_view included) {
  const auto covers = [&](std::string_view rule) {
    return rule.ends_with('/') ? included.starts_with(rule) : included == rule;
  };
  return included.starts_with(room.folder) || std::any_of(room.allowed.begin(), room.allowed.end(), covers);
}

struct Include {
  std::string_view name;
  bool quoted = false;
};

std::string_view without_blanks(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t");
  return start == std::string_view::npos ? std::string_view{} : text.substr(start);
}

std::optional<Include> parse_include(std::string_view line) {
  line = without_blanks(line);
  if (!line.starts_with('#')) {
    return std::nullopt;
  }
  line = without_blanks(line.substr(1));
  constexpr std::string_view kDirective = "include";
  if (!line.starts_with(kDirective)) {
    return std::nullopt;
  }
  line = without_blanks(line.substr(kDirective.size()));
  if (line.empty() || (line.front() != '"' && line.front() != '<')) {
    return std::nullopt;
  }
  const bool quoted = line.front() == '"';
  const std::size_t end = line.find(quoted ? '"' : '>', 1);
  return Include{line.substr(1, end == std::string_view::npos ? end : end - 1), quoted};
}

/// Empty where the include is in order.
std::string objection(const Room& room, const Include& include) {
  if (include.name.starts_with("tests/")) {
    return "no room may include a test";
  }
  const Room* target = room_of(include.name);
  if (target == nullptr) {
    return include.quoted ? "is no header of a room, named from the project's root" : "";
  }
  if (!allows(room, include.name)) {
    return std::string(room.folder) + " may not include this of " + std::string(target->folder);
  }
  return "";
}

}  // namespace

std::string to_string(const Violation& violation) {
  return violation.file + ":" + std::to_string(violation.line) + ": \"" + violation.included +
         "\": " + violation.reason;
}

std::vector<std::string> room_names() {
  std::vector<std::string> names;
  for (const Room& room : kRooms) {
    names.emplace_back(room.folder.substr(0, room.folder.size() - 1));
  }
  return names;
}

std::vector<Violation> check_text(std::string_view file, std::string_view text) {
  std::vector<Violation> found;
  const Room* room = room_of(file);
  if (room == nullptr) {
    return found;
  }
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::optional<Include> include = parse_include(line);
    if (!include) {
      continue;
    }
    std::string reason = objection(*room, *include);
    if (!reason.empty()) {
      found.push_back({std::string(file), number, std::string(include->name), std::move(reason)});
    }
  }
  return found;
}

std::vector<Violation> check_tree(const std::filesystem::path& root, std::size_t& files_read) {
  std::vector<Violation> found;
  for (const std::string& room : room_names()) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / room)) {
      const std::string extension = entry.path().extension().string();
      if (!entry.is_regular_file() || (extension != ".h" && extension != ".cpp")) {
        continue;
      }
      ++files_read;
      std::ifstream stream(entry.path());
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      const std::vector<Violation> in_file =
          check_text(std::filesystem::relative(entry.path(), root).generic_string(), text);
      found.insert(found.end(), in_file.begin(), in_file.end());
    }
  }
  return found;
}

}  // namespace rooms
