#include "bridges/text/json_text.h"

#include <algorithm>
#include <array>
#include <boost/json/serialize.hpp>
#include <charconv>
#include <cmath>

#include "bridges/text/utf8.h"

namespace text {
namespace {

bool stands_for_itself(char character) {
  return character >= ' ' && character <= '~' && character != '"' && character != '\\';
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

void append_quoted(std::string& out, std::string_view text) {
  if (std::all_of(text.begin(), text.end(), stands_for_itself)) {
    out += '"';
    out += text;
    out += '"';
    return;
  }
  if (is_utf8(text)) {
    out += boost::json::serialize(boost::json::string_view(text.data(), text.size()));
    return;
  }
  const std::string repaired = repaired_utf8(text);
  out += boost::json::serialize(boost::json::string_view(repaired));
}

std::string& ObjectText::key(std::string_view name) {
  append_separator(out_, first_);
  append_quoted(out_, name);
  out_ += ':';
  return out_;
}

void ObjectText::text(std::string_view name, std::string_view value) {
  append_quoted(key(name), value);
}

void ObjectText::boolean(std::string_view name, bool value) {
  key(name) += value ? "true" : "false";
}

void ObjectText::integer(std::string_view name, std::int64_t value) {
  key(name) += std::to_string(value);
}

void ObjectText::null(std::string_view name) {
  key(name) += "null";
}

void ObjectText::number(std::string_view name, std::optional<double> value) {
  std::string& out = key(name);
  if (!value || !append_number(out, *value)) {
    out += "null";
  }
}

void append_separator(std::string& out, bool& first) {
  if (!first) {
    out += ',';
  }
  first = false;
}

bool append_number(std::string& out, double value) {
  return append_shortest(out, value);
}

bool append_number(std::string& out, float value) {
  return append_shortest(out, value);
}

}  // namespace text
