#include "bridges/text/json_text.h"

#include <algorithm>
#include <array>
#include <boost/json/parse.hpp>
#include <boost/json/serialize.hpp>
#include <charconv>
#include <cmath>
#include <utility>

namespace text {
namespace {

namespace json = boost::json;

bool stands_for_itself(char character) {
  return character >= ' ' && character <= '~' && character != '"' && character != '\\';
}

bool is_plain(std::string_view text) {
  return std::all_of(text.begin(), text.end(), stands_for_itself);
}

// Nothing where the text is no UTF-8: Boost.JSON looks for that when it reads, not when it writes.
std::optional<std::string> quoted(std::string_view text) {
  std::string written = json::serialize(json::string_view(text.data(), text.size()));
  json::error_code failure;
  (void)json::parse(written, failure);
  return failure ? std::nullopt : std::optional(std::move(written));
}

// Each byte that belongs to no character becomes U+FFFD; all else stays.
std::string repaired(std::string_view text) {
  constexpr std::size_t kLongestCharacter = 4;
  std::string sound;
  while (!text.empty()) {
    std::size_t length = 1;
    while (length <= kLongestCharacter && !quoted(text.substr(0, length))) {
      ++length;
    }
    const bool is_character = length <= std::min(kLongestCharacter, text.size());
    sound += is_character ? text.substr(0, length) : std::string_view("\xEF\xBF\xBD");
    text.remove_prefix(is_character ? length : 1);
  }
  return sound;
}

template <class Real>
bool append_shortest(std::string& out, Real value) {
  if (!std::isfinite(value)) {
    return false;
  }
  std::array<char, 32> digits{};
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  out.append(digits.data(), end.ptr);
  return true;
}

}  // namespace

bool is_utf8(std::string_view text) {
  return is_plain(text) || quoted(text);
}

void append_quoted(std::string& out, std::string_view text) {
  if (is_plain(text)) {
    out += '"';
    out += text;
    out += '"';
  } else if (const auto written = quoted(text)) {
    out += *written;
  } else {
    append_quoted(out, repaired(text));
  }
}

bool append_number(std::string& out, double value) {
  return append_shortest(out, value);
}

bool append_number(std::string& out, float value) {
  return append_shortest(out, value);
}

std::string& ObjectText::key(std::string_view name) {
  out_ += first_ ? "" : ",";
  first_ = false;
  append_quoted(out_, name);
  out_ += ':';
  return out_;
}

void ObjectText::text(std::string_view name, std::optional<std::string_view> value) {
  if (value) {
    append_quoted(key(name), *value);
  } else {
    null(name);
  }
}

void ObjectText::boolean(std::string_view name, bool value) {
  key(name) += value ? "true" : "false";
}

void ObjectText::integer(std::string_view name, std::optional<std::int64_t> value) {
  key(name) += value ? std::to_string(*value) : "null";
}

void ObjectText::number(std::string_view name, std::optional<double> value) {
  std::string& out = key(name);
  if (!value || !append_number(out, *value)) {
    out += "null";
  }
}

void ObjectText::null(std::string_view name) {
  key(name) += "null";
}

}  // namespace text
