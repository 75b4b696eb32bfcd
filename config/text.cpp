#include "config/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <system_error>

namespace config {
namespace {

struct TimeUnit {
  std::string_view name;
  canopen::Duration length;
};

// From long to short: the first that divides a duration evenly is the one to write it in.
constexpr std::array<TimeUnit, 5> kUnits{{{"h", std::chrono::hours(1)},
                                          {"min", std::chrono::minutes(1)},
                                          {"s", std::chrono::seconds(1)},
                                          {"ms", std::chrono::milliseconds(1)},
                                          {"us", std::chrono::microseconds(1)}}};

struct SizeUnit {
  std::string_view name;
  std::uint64_t bytes;
};

// From large to small, as above.
constexpr std::array<SizeUnit, 4> kSizeUnits{{{"GB", 1'000'000'000}, {"MB", 1'000'000}, {"kB", 1'000}, {"B", 1}}};

constexpr double kLargestSize = 1e15;

constexpr canopen::Duration kLongestDuration = std::chrono::hours(24 * 3650);

bool is_digit(char c) noexcept {
  return c >= '0' && c <= '9';
}

bool is_lower(char c) noexcept {
  return c >= 'a' && c <= 'z';
}

std::string_view trim(std::string_view text) {
  const auto first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) {
    return {};
  }
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// `12.5ms`: a number and the unit behind it; nothing on any other text.
template <class Units>
std::optional<std::pair<double, typename Units::value_type>> amount_in(const Units& units, std::string_view text) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed);
  if (error != std::errc() || text.empty() || !is_digit(text.front()) || !std::isfinite(number)) {
    return std::nullopt;
  }
  const std::string_view name = text.substr(static_cast<std::size_t>(end - text.data()));
  const auto unit = std::find_if(units.begin(), units.end(), [name](const auto& known) { return known.name == name; });
  return unit == units.end() ? std::nullopt : std::optional(std::pair(number, *unit));
}

}  // namespace

std::optional<canopen::Duration> parse_duration(std::string_view text) {
  const auto amount = amount_in(kUnits, text);
  if (!amount) {
    return std::nullopt;
  }
  const auto& [number, unit] = *amount;
  const double nanoseconds = number * static_cast<double>(unit.length.count());
  if (nanoseconds > static_cast<double>(kLongestDuration.count())) {
    return std::nullopt;
  }
  return canopen::Duration(std::llround(nanoseconds));
}

std::string to_text(canopen::Duration duration) {
  if (duration == canopen::Duration::zero()) {
    return "0s";
  }
  for (const TimeUnit& unit : kUnits) {
    if (duration % unit.length == canopen::Duration::zero()) {
      return std::to_string(duration / unit.length) + std::string(unit.name);
    }
  }
  return to_text(static_cast<double>(duration.count()) / 1000.0) + "us";
}

bool whole_milliseconds(canopen::Duration duration) noexcept {
  return duration % std::chrono::milliseconds(1) == canopen::Duration::zero();
}

std::optional<std::uint64_t> parse_size(std::string_view text) {
  const auto amount = amount_in(kSizeUnits, text);
  if (!amount) {
    return std::nullopt;
  }
  const auto& [number, unit] = *amount;
  const double bytes = number * static_cast<double>(unit.bytes);
  // What is meant may be no binary fraction: 1.1 kB are 1100 bytes.
  constexpr double kNoise = 1e-6;
  if (bytes > kLargestSize || std::abs(bytes - std::round(bytes)) > kNoise) {
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(std::llround(bytes));
}

std::string size_text(std::uint64_t bytes) {
  const auto* const unit = std::find_if(kSizeUnits.begin(), kSizeUnits.end(), [bytes](const SizeUnit& known) {
    return bytes % known.bytes == 0 && bytes >= known.bytes;
  });
  return unit == kSizeUnits.end() ? "0B" : std::to_string(bytes / unit->bytes) + std::string(unit->name);
}

std::optional<std::int64_t> parse_integer(std::string_view text) {
  const bool negative = text.starts_with('-');
  std::string_view digits = negative ? text.substr(1) : text;
  int base = 10;
  if (digits.starts_with("0x") || digits.starts_with("0X")) {
    base = 16;
    digits.remove_prefix(2);
  }
  if (digits.empty() || digits.front() == '-' || digits.front() == '+') {
    return std::nullopt;
  }
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number, base);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    return std::nullopt;
  }
  return negative ? -number : number;
}

std::string to_text(double number) {
  std::array<char, 64> buffer{};
  const bool plain = std::abs(number) < 1e15 && (number == 0.0 || std::abs(number) >= 1e-9);
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number,
                                          plain ? std::chars_format::fixed : std::chars_format::scientific);
  return error == std::errc() ? std::string(buffer.data(), end) : std::string("0");
}

std::string to_hex(std::uint64_t number) {
  std::array<char, 24> buffer{};
  const int length = std::snprintf(buffer.data(), buffer.size(), "0x%04llX", static_cast<unsigned long long>(number));
  return {buffer.data(), static_cast<std::size_t>(std::max(length, 0))};
}

bool is_name(std::string_view text) noexcept {
  return !text.empty() && text.size() <= 32 && std::all_of(text.begin(), text.end(), [](char c) {
    return is_lower(c) || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_' || c == '-';
  });
}

bool is_signal_name(std::string_view text) noexcept {
  return !text.empty() && text.size() <= 64 && is_lower(text.front()) &&
         std::all_of(text.begin(), text.end(), [](char c) { return is_lower(c) || is_digit(c) || c == '_'; });
}

bool is_plain_text(std::string_view text) noexcept {
  return text.size() <= 200 && std::none_of(text.begin(), text.end(),
                                            [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

std::optional<canopen::ObjectAddress> parse_stated_object(std::string_view text) {
  return text.starts_with("0x") || text.starts_with("0X") ? canopen::parse_object(text) : std::nullopt;
}

std::optional<std::pair<canopen::ObjectAddress, canopen::DataType>> parse_mapped(std::string_view text) {
  const auto space = text.find(' ');
  if (space == std::string_view::npos) {
    return std::nullopt;
  }
  const auto object = parse_stated_object(text.substr(0, space));
  const auto type = canopen::parse_type(trim(text.substr(space)));
  if (!object.has_value() || !type.has_value()) {
    return std::nullopt;
  }
  return std::pair(*object, *type);
}

std::optional<CobId> parse_cob_id(std::string_view text) {
  constexpr std::string_view kNodeId = "$NODEID";
  constexpr std::int64_t kLast = 0x7FF;
  const auto plus = text.find('+');
  const std::string_view left = trim(text.substr(0, plus));
  const std::string_view right = plus == std::string_view::npos ? "" : trim(text.substr(plus + 1));
  const bool plus_node = plus != std::string_view::npos;
  if (plus_node && left != kNodeId && right != kNodeId) {
    return std::nullopt;
  }
  const auto number = parse_integer(plus_node && left == kNodeId ? right : left);
  if (!number.has_value() || *number < (plus_node ? 0 : 1) || *number > kLast) {
    return std::nullopt;
  }
  return CobId{.base = *number, .plus_node = plus_node};
}

std::optional<std::int64_t> parse_decimal(std::string_view text) {
  const bool digits = !text.empty() && std::all_of(text.begin(), text.end(), is_digit);
  return digits && (text.size() == 1 || text.front() != '0') ? parse_integer(text) : std::nullopt;
}

}  // namespace config
