#include "bridges/recorder/record_name.h"

#include <algorithm>
#include <array>

#include "bridges/text/timestamp.h"

namespace recorder {
namespace {

constexpr std::array<std::string_view, 7> kKinds{"emcy", "heartbeat", "boot", "data", "control", "bus", kRequest};
// 20260102T030405.678Z
constexpr std::size_t kTimeSize = 20;
constexpr std::size_t kLongestSubject = 32;

bool is_subject(std::string_view text) {
  return !text.empty() && text.size() <= kLongestSubject && std::ranges::all_of(text, [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

// Colons are no letters of a file name everywhere.
std::string compact_time(canopen::WallTime wall) {
  std::string text = text::timestamp(wall);
  std::erase_if(text, [](char c) { return c == '-' || c == ':'; });
  return text;
}

std::optional<canopen::WallTime> time_of(std::string_view text) {
  std::string full(text);
  for (const std::size_t dash : {std::size_t{4}, std::size_t{7}}) {
    full.insert(dash, 1, '-');
  }
  for (const std::size_t colon : {std::size_t{13}, std::size_t{16}}) {
    full.insert(colon, 1, ':');
  }
  return text::parse_timestamp(full);
}

}  // namespace

std::string to_text(const RecordName& name) {
  return compact_time(name.wall) + '-' + name.subject + '-' + name.kind;
}

std::optional<RecordName> parse_record_name(std::string_view text) {
  const std::size_t last = text.rfind('-');
  if (last == std::string_view::npos || last < kTimeSize + 1 || text[kTimeSize] != '-') {
    return std::nullopt;
  }
  const std::string_view kind = text.substr(last + 1);
  const std::string_view subject = text.substr(kTimeSize + 1, std::max(last, kTimeSize + 1) - (kTimeSize + 1));
  const auto wall = time_of(text.substr(0, kTimeSize));
  if (!wall || !is_subject(subject) || std::ranges::find(kKinds, kind) == kKinds.end()) {
    return std::nullopt;
  }
  return RecordName{*wall, std::string(subject), std::string(kind)};
}

}  // namespace recorder
