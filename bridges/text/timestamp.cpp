#include "bridges/text/timestamp.h"

#include <charconv>
#include <chrono>

namespace text {
namespace {

constexpr std::string_view kForm = "0000-00-00T00:00:00.000Z";

void append_padded(std::string& text, unsigned number, std::size_t digits) {
  const std::string plain = std::to_string(number);
  if (plain.size() < digits) {
    text.append(digits - plain.size(), '0');
  }
  text += plain;
}

unsigned number_at(std::string_view text, std::size_t position, std::size_t digits) {
  unsigned number = 0;
  std::from_chars(text.data() + position, text.data() + position + digits, number);
  return number;
}

bool has_form(std::string_view text) {
  if (text.size() != kForm.size()) {
    return false;
  }
  for (std::size_t i = 0; i < kForm.size(); ++i) {
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (kForm[i] == '0' ? !digit : text[i] != kForm[i]) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string timestamp(canopen::WallTime time) {
  using namespace std::chrono;
  const auto whole = floor<milliseconds>(time);
  const auto day = floor<days>(whole);
  const year_month_day date(day);
  const hh_mm_ss clock(whole - day);
  std::string text;
  text.reserve(kForm.size());
  append_padded(text, static_cast<unsigned>(static_cast<int>(date.year())), 4);
  text += '-';
  append_padded(text, static_cast<unsigned>(date.month()), 2);
  text += '-';
  append_padded(text, static_cast<unsigned>(date.day()), 2);
  text += 'T';
  append_padded(text, static_cast<unsigned>(clock.hours().count()), 2);
  text += ':';
  append_padded(text, static_cast<unsigned>(clock.minutes().count()), 2);
  text += ':';
  append_padded(text, static_cast<unsigned>(clock.seconds().count()), 2);
  text += '.';
  append_padded(text, static_cast<unsigned>(clock.subseconds().count()), 3);
  text += 'Z';
  return text;
}

std::optional<canopen::WallTime> parse_timestamp(std::string_view text) {
  using namespace std::chrono;
  if (!has_form(text)) {
    return std::nullopt;
  }
  const unsigned of_year = number_at(text, 0, 4);
  const year_month_day date(year(static_cast<int>(of_year)), month(number_at(text, 5, 2)), day(number_at(text, 8, 2)));
  const unsigned of_hours = number_at(text, 11, 2);
  const unsigned of_minutes = number_at(text, 14, 2);
  const unsigned of_seconds = number_at(text, 17, 2);
  // Nanoseconds in 64 bits reach from 1678 to 2262.
  if (!date.ok() || of_year < 1970 || of_year > 2200 || of_hours > 23 || of_minutes > 59 || of_seconds > 59) {
    return std::nullopt;
  }
  return sys_days(date) + hours(of_hours) + minutes(of_minutes) + seconds(of_seconds) +
         milliseconds(number_at(text, 20, 3));
}

}  // namespace text
