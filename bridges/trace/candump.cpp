#include "bridges/trace/candump.h"

#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>

#include "canopen/hex.h"

namespace trace {
namespace {

using canopen::Frame;
using canopen::hex;

// As linux/can.h has them in an identifier.
constexpr std::uint32_t kErrorFlag = 0x20000000;
constexpr std::uint32_t kMax29Bits = 0x1FFFFFFF;
constexpr std::size_t kShortId = 3;
constexpr std::size_t kLongId = 8;
constexpr std::size_t kFractionDigits = 6;
// Beyond it nanoseconds of 64 bits end: the year 2262.
constexpr std::int64_t kMostSeconds = 9'000'000'000;

template <class Number>
bool read_number(std::string_view text, Number& number, int base) {
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  return failed == std::errc{} && end == text.data() + text.size() && !text.empty() && text.front() != '-';
}

// What stands before the first blank; it and the blank are taken off `text`.
std::string_view take_word(std::string_view& text) {
  const std::size_t end = std::min(text.find(' '), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

bool read_time(std::string_view word, canopen::WallTime& at) {
  if (word.size() < 3 || word.front() != '(' || word.back() != ')') {
    return false;
  }
  word = word.substr(1, word.size() - 2);
  const std::size_t point = word.find('.');
  std::int64_t seconds = 0;
  std::uint32_t microseconds = 0;
  if (point == std::string_view::npos || word.size() - point - 1 != kFractionDigits ||
      !read_number(word.substr(0, point), seconds, 10) || !read_number(word.substr(point + 1), microseconds, 10) ||
      seconds > kMostSeconds) {
    return false;
  }
  at = canopen::WallTime(std::chrono::seconds(seconds) + std::chrono::microseconds(microseconds));
  return true;
}

bool read_id(std::string_view digits, Frame& frame) {
  std::uint32_t id = 0;
  if ((digits.size() != kShortId && digits.size() != kLongId) || !read_number(digits, id, 16)) {
    return false;
  }
  frame.error = digits.size() == kLongId && (id & kErrorFlag) != 0;
  frame.extended = digits.size() == kLongId && !frame.error;
  frame.id = id & kMax29Bits;
  return digits.size() == kShortId ? id <= canopen::kMaxCobId : (id & ~(kErrorFlag | kMax29Bits)) == 0;
}

// `R`, `R8`
bool read_remote(std::string_view text, Frame& frame) {
  frame.remote = true;
  text.remove_prefix(1);
  if (text.empty()) {
    return true;
  }
  return text.size() == 1 && read_number(text, frame.size, 10) && frame.size <= frame.data.size();
}

// Dots may stand between the bytes.
bool read_data(std::string_view text, Frame& frame) {
  while (!text.empty()) {
    if (frame.size > 0 && text.front() == '.') {
      text.remove_prefix(1);
    }
    if (frame.size == frame.data.size() || text.size() < 2 ||
        !read_number(text.substr(0, 2), frame.data.at(frame.size), 16)) {
      return false;
    }
    ++frame.size;
    text.remove_prefix(2);
  }
  return true;
}

bool read_frame(std::string_view word, Frame& frame) {
  const std::size_t mark = word.find('#');
  if (mark == std::string_view::npos || !read_id(word.substr(0, mark), frame)) {
    return false;
  }
  const std::string_view rest = word.substr(mark + 1);
  return rest.starts_with('R') ? read_remote(rest, frame) : read_data(rest, frame);
}

}  // namespace

std::string candump_frame(const Frame& frame) {
  std::string text = frame.error      ? hex(frame.id | kErrorFlag, kLongId)
                     : frame.extended ? hex(frame.id, kLongId)
                                      : hex(frame.id, kShortId);
  text += '#';
  if (frame.remote) {
    return text + "R" + (frame.size > 0 ? std::to_string(frame.size) : "");
  }
  for (const std::uint8_t byte : frame.bytes()) {
    text += hex(byte, 2);
  }
  return text;
}

std::string candump_line(canopen::WallTime at, std::string_view interface, const Frame& frame) {
  const auto whole = std::chrono::floor<std::chrono::microseconds>(at.time_since_epoch()).count();
  constexpr std::int64_t kMicroseconds = 1'000'000;
  const std::string fraction = std::to_string(kMicroseconds + whole % kMicroseconds).substr(1);
  std::string line = "(" + std::to_string(whole / kMicroseconds) + "." + fraction + ") ";
  return line.append(interface).append(" ").append(candump_frame(frame));
}

std::variant<LoggedFrame, NoFrame> parse_candump_line(std::string_view line) {
  if (line.size() > kMaxLogLine) {
    return NoFrame{"longer than a line of candump"};
  }
  LoggedFrame logged;
  if (!read_time(take_word(line), logged.at)) {
    return NoFrame{"does not begin with a time as in \"(1767323045.678123) can0 185#0102\" (candump -L)"};
  }
  logged.interface = take_word(line);
  if (logged.interface.empty()) {
    return NoFrame{"the interface is missing: \"(1767323045.678123) can0 185#0102\""};
  }
  const std::string_view frame = take_word(line);
  if (frame.find("##") != std::string_view::npos) {
    return NoFrame{"a frame of CAN FD, which CANopen does not use"};
  }
  if (!read_frame(frame, logged.frame)) {
    return NoFrame{"no frame as in 185#0102, behind the interface"};
  }
  if (!line.empty() && line != "R" && line != "T") {
    return NoFrame{"something stands behind the frame"};
  }
  logged.origin = line == "T" ? canopen::FrameOrigin::ourselves : canopen::FrameOrigin::others;
  if (logged.frame.error) {
    logged.origin = canopen::FrameOrigin::driver;
  }
  return logged;
}

}  // namespace trace
