#include "bridges/text/timestamp.h"

#include <array>
#include <charconv>
#include <chrono>
#include <cstdio>

namespace text {
namespace {

int number_at(std::string_view text, std::size_t position, std::size_t digits) {
  int number = 0;
  std::from_chars(text.data() + position, text.data() + position + digits, number);
  return number;
}

}  // namespace

std::string timestamp(canopen::WallTime time) {
  using namespace std::chrono;
  const auto whole = floor<milliseconds>(time);
  const auto day = floor<days>(whole);
  const year_month_day date(day);
  const hh_mm_ss clock(whole - day);
  std::array<char, 64> text{};
  const int size =
      std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02d.%03dZ", static_cast<int>(date.year()),
                    static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                    static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                    static_cast<int>(clock.seconds().count()), static_cast<int>(clock.subseconds().count()));
  return {text.data(), static_cast<std::size_t>(size)};
}

std::optional<canopen::WallTime> parse_timestamp(std::string_view text) {
  using namespace std::chrono;
  constexpr std::string_view kForm = "0000-00-00T00:00:00.000Z";
  if (text.size() != kForm.size()) {
    return std::nullopt;
  }
  const year_month_day date(year(number_at(text, 0, 4)), month(static_cast<unsigned>(number_at(text, 5, 2))),
                            day(static_cast<unsigned>(number_at(text, 8, 2))));
  // Nanoseconds in 64 bits reach from 1678 to 2262.
  if (!date.ok() || date.year() < year(1970) || date.year() > year(2200)) {
    return std::nullopt;
  }
  const canopen::WallTime time = sys_days(date) + hours(number_at(text, 11, 2)) + minutes(number_at(text, 14, 2)) +
                                 seconds(number_at(text, 17, 2)) + milliseconds(number_at(text, 20, 3));
  return timestamp(time) == text ? std::optional(time) : std::nullopt;
}

}  // namespace text
