#include "bridges/trace/line.h"

#include <fmt/format.h>

#include <chrono>
#include <cstdint>

#include "bridges/text/timestamp.h"
#include "bridges/trace/candump.h"
#include "bridges/trace/words.h"

namespace trace {
namespace {

// RFC 3339 with microseconds: frames of a fast bus come several in a millisecond.
std::string precise_time(canopen::WallTime at) {
  std::string time = text::timestamp(at);
  const auto rest = std::chrono::floor<std::chrono::microseconds>(at.time_since_epoch()).count() % 1000;
  time.insert(time.size() - 1, fmt::format("{:03}", rest));
  return time;
}

// `03:04:05.678123`
std::string_view time_of_day(std::string_view time) {
  const std::size_t day = time.find('T');
  if (day == std::string_view::npos) {
    return time;
  }
  time.remove_prefix(day + 1);
  return time.ends_with('Z') ? time.substr(0, time.size() - 1) : time;
}

}  // namespace

std::string_view log_interface(const config::Bus& bus) noexcept {
  return bus.interface == config::kVirtualInterface ? bus.name : bus.interface;
}

Line line_of(const config::Model& model, const Entry& entry, std::string_view interface) {
  return {.time = precise_time(entry.at),
          .bus = entry.bus ? model.buses.at(*entry.bus).name : std::string(interface),
          .frame = entry.lost > 0 ? std::string() : candump_frame(entry.frame),
          .own = entry.origin == canopen::FrameOrigin::ourselves,
          .kind = std::string(name_of(entry.kind)),
          .owner = owner_of(model, entry),
          .name = heading_of(entry),
          .text = words_of(model, entry)};
}

void append_members(text::ObjectText& object, const Line& line) {
  object.text("ts", line.time);
  object.text("bus", line.bus);
  object.text("frame", line.frame);
  object.boolean("own", line.own);
  object.text("kind", line.kind);
  object.text("owner", line.owner);
  object.text("name", line.name);
  object.text("text", line.text);
}

std::string terminal_line(const Line& line) {
  const std::string_view mark = line.kind == name_of(Kind::error) ? "!" : line.own ? ">" : " ";
  const std::string_view id = std::string_view(line.frame).substr(0, line.frame.find('#'));
  std::string text = fmt::format("{} {} {}{:<3} {:<10} {:<9} {}", time_of_day(line.time), line.bus, mark,
                                 line.kind == name_of(Kind::error) ? "" : id, line.owner, line.name, line.text);
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace trace
