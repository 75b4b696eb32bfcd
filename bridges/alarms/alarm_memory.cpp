#include "bridges/alarms/alarm_memory.h"

#include <algorithm>
#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>
#include <utility>

#include "bridges/alarms/alarm_json.h"
#include "bridges/alarms/alarm_reader.h"
#include "bridges/text/json_text.h"

namespace alarms {
namespace {

namespace json = boost::json;

constexpr int kVersion = 1;

std::string plain(json::string_view text) {
  return {text.data(), text.size()};
}

std::string drive_text(const AlarmMemory::OfDrive& drive) {
  std::string out;
  text::ObjectText object(out);
  for (const AlarmKind kind : kAlarmKinds) {
    if (const auto& alarm = drive.alarms.at(static_cast<std::size_t>(kind))) {
      object.key(name_of(kind)) += alarm_json(*alarm);
    }
  }
  object.close();
  return out;
}

void append_fault(std::string& out, const std::optional<NamedFault>& fault) {
  if (!fault) {
    out += "null";
    return;
  }
  text::ObjectText object(out);
  if (fault->drive.empty()) {
    object.text("bus", fault->bus);
  } else {
    object.text("drive", fault->drive);
    object.text("kind", name_of(fault->kind));
  }
  object.close();
}

/// Reads one document; remembers the first thing that is wrong.
class MemoryReader {
 public:
  explicit MemoryReader(const json::object& document) : document_(document) {}

  ReadMemory read() {
    const json::value* version = document_.if_contains("version");
    if (version == nullptr || *version != kVersion) {
      wrong_ = "\"version\" is not " + std::to_string(kVersion);
    }
    read_text(document_, "gateway", memory_.gateway);
    if (const json::object* drives = object("drives")) {
      for (const auto& [name, value] : *drives) {
        read_drive(plain(name), value);
      }
    }
    if (const json::object* buses = object("buses")) {
      for (const auto& [name, value] : *buses) {
        memory_.buses.push_back({plain(name), read_one(value, "bus " + plain(name))});
      }
    }
    read_first();
    return wrong_.empty() ? ReadMemory{std::move(memory_), {}} : ReadMemory{{}, std::move(wrong_)};
  }

 private:
  void complain(const std::string& text) {
    if (wrong_.empty()) {
      wrong_ = text;
    }
  }
  void read_text(const json::object& object, json::string_view name, std::string& out) {
    const json::value* value = object.if_contains(name);
    const json::string* text = value != nullptr ? value->if_string() : nullptr;
    if (text == nullptr) {
      complain("\"" + plain(name) + "\" is not a text");
    } else {
      out = plain(*text);
    }
  }
  const json::object* object(json::string_view name) {
    const json::value* value = document_.if_contains(name);
    const json::object* object = value != nullptr ? value->if_object() : nullptr;
    if (object == nullptr) {
      complain("\"" + plain(name) + "\" is not an object");
    }
    return object;
  }
  Alarm read_one(const json::value& value, const std::string& of) {
    ReadAlarm read = read_alarm(value);
    if (!read.wrong.empty()) {
      complain(of + ": " + read.wrong);
    }
    return std::move(read.alarm);
  }
  void read_drive(std::string name, const json::value& value) {
    const json::object* kinds = value.if_object();
    if (kinds == nullptr) {
      complain("drive " + name + " is not an object");
      return;
    }
    AlarmMemory::OfDrive drive;
    for (const AlarmKind kind : kAlarmKinds) {
      const std::string_view of = name_of(kind);
      if (const json::value* alarm = kinds->if_contains(json::string_view(of.data(), of.size()))) {
        drive.alarms.at(static_cast<std::size_t>(kind)) = read_one(*alarm, "drive " + name + ", " + std::string(of));
      }
    }
    drive.name = std::move(name);
    memory_.drives.push_back(std::move(drive));
  }
  void read_first() {
    const json::value* value = document_.if_contains("first");
    if (value != nullptr && value->is_null()) {
      return;
    }
    const json::object* fault = object("first");
    if (fault == nullptr) {
      return;
    }
    NamedFault& first = memory_.newest_first.emplace();
    if (fault->contains("bus")) {
      read_text(*fault, "bus", first.bus);
      return;
    }
    std::string of;
    read_text(*fault, "drive", first.drive);
    read_text(*fault, "kind", of);
    const auto* const kind = std::ranges::find_if(kAlarmKinds, [&](AlarmKind each) { return name_of(each) == of; });
    if (kind == kAlarmKinds.end()) {
      complain("\"kind\" is not a kind of alarm");
    } else {
      first.kind = *kind;
    }
  }

  const json::object& document_;
  AlarmMemory memory_;
  std::string wrong_;
};

}  // namespace

std::string memory_text(const AlarmMemory& memory) {
  std::string out;
  text::ObjectText object(out);
  object.integer("version", kVersion);
  object.text("gateway", memory.gateway);
  text::ObjectText drives(object.key("drives"));
  for (const AlarmMemory::OfDrive& drive : memory.drives) {
    drives.key(drive.name) += "\n" + drive_text(drive);
  }
  drives.close();
  text::ObjectText buses(object.key("buses"));
  for (const AlarmMemory::OfBus& bus : memory.buses) {
    buses.key(bus.name) += "\n" + alarm_json(bus.alarm);
  }
  buses.close();
  append_fault(object.key("first"), memory.newest_first);
  object.close();
  return out += '\n';
}

ReadMemory parse_memory(std::string_view text) {
  json::error_code failure;
  const json::value value = json::parse(json::string_view(text.data(), text.size()), failure);
  if (failure) {
    return {{}, "it is no JSON: " + failure.message()};
  }
  const json::object* document = value.if_object();
  return document == nullptr ? ReadMemory{{}, "it is no object"} : MemoryReader(*document).read();
}

}  // namespace alarms
