#include "bridges/recorder/candump.h"

#include <charconv>
#include <chrono>

namespace recorder {
namespace {

// linux/can.h
constexpr std::uint32_t kErrorFlag = 0x20000000;
constexpr std::string_view kDigits = "0123456789ABCDEF";

void append_hex(std::string& out, std::uint32_t value, unsigned digits) {
  for (unsigned i = digits; i > 0; --i) {
    out += kDigits[(value >> (4U * (i - 1U))) & 0xFU];
  }
}

void append_time(std::string& out, canopen::WallTime wall) {
  const std::int64_t all = std::chrono::floor<std::chrono::microseconds>(wall).time_since_epoch().count();
  std::array<char, 24> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), all / 1'000'000);
  out.append("(").append(text.data(), end.ptr).append(".");
  const auto micros = static_cast<std::uint32_t>(all % 1'000'000);
  for (std::uint32_t place = 100'000; place > 0; place /= 10) {
    out += kDigits[micros / place % 10];
  }
  out += ") ";
}

}  // namespace

void append_candump(std::string& out, std::string_view interface, const KeptFrame& frame) {
  if (frame.kind == KeptFrame::Kind::gap) {
    return;
  }
  append_time(out, frame.wall);
  out.append(interface).append(" ");
  if (frame.kind == KeptFrame::Kind::error) {
    append_hex(out, frame.id | kErrorFlag, 8);
  } else {
    append_hex(out, frame.id, frame.extended ? 8 : 3);
  }
  out += '#';
  if (frame.kind == KeptFrame::Kind::remote) {
    out += 'R';
    if (frame.size > 0) {
      append_hex(out, frame.size, 1);
    }
  } else {
    for (std::size_t i = 0; i < frame.size; ++i) {
      append_hex(out, frame.data.at(i), 2);
    }
  }
  out += '\n';
}

}  // namespace recorder
