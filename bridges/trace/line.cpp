#include "bridges/trace/line.h"

#include <algorithm>
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
  constexpr std::int64_t kThousand = 1000;
  const auto whole = std::chrono::floor<std::chrono::microseconds>(at.time_since_epoch()).count();
  time.insert(time.size() - 1, std::to_string(kThousand + whole % kThousand).substr(1));
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

// Filled up with blanks, and one behind it.
void append_column(std::string& text, std::string_view cell, std::size_t width) {
  text.append(cell).append(width + 1 - std::min(cell.size(), width), ' ');
}

}  // namespace

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
  const bool is_error = line.kind == name_of(Kind::error);
  const std::string_view mark = is_error ? "!" : line.own ? ">" : " ";
  const std::string_view id = std::string_view(line.frame).substr(0, is_error ? 0 : line.frame.find('#'));
  std::string text(time_of_day(line.time));
  text.append(" ").append(line.bus).append(" ").append(mark);
  append_column(text, id, 3);
  append_column(text, line.owner, 10);
  append_column(text, line.name, 9);
  text += line.text;
  text.erase(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace trace
