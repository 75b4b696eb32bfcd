#include "daemon/control/order_text.h"

#include <boost/json/parse.hpp>
#include <boost/json/value.hpp>
#include <charconv>
#include <cstdint>

#include "bridges/text/json_text.h"
#include "bridges/text/number_text.h"

namespace gateway::control {
namespace {

// As it stands, digits kept: 64 bits are more than a double holds.
bool is_json_number(std::string_view word) {
  if (word.find_first_of(" \t\r\n") != std::string_view::npos) {
    return false;  // JSON would let it pass, and a request is one line
  }
  boost::json::error_code failed;
  const boost::json::value value = boost::json::parse(boost::json::string_view(word.data(), word.size()), failed);
  return !failed && value.is_number();
}

std::string quoted(std::string_view text) {
  std::string out;
  text::append_quoted(out, text);
  return out;
}

}  // namespace

std::string json_of(std::string_view word) {
  if (word == "true" || word == "false" || is_json_number(word)) {
    return std::string(word);
  }
  // Numbers that JSON writes in another way: 050, .5
  if (const canopen::Result<double> number = text::number_of(word)) {
    std::string out;
    text::append_number(out, number.value());
    return out;
  }
  return quoted(word);
}

std::string json_of_raw(std::string_view word) {
  if (!word.starts_with("0x") && !word.starts_with("0X")) {
    return json_of(word);
  }
  std::uint64_t number = 0;
  const char* const end = word.data() + word.size();
  const auto [stopped, error] = std::from_chars(word.data() + 2, end, number, 16);
  return error == std::errc{} && stopped == end ? std::to_string(number) : quoted(word);
}

std::optional<std::string> values_of(const std::vector<std::string>& assignments) {
  std::string out;
  text::ObjectText object(out);
  for (const std::string& assignment : assignments) {
    const std::size_t sign = assignment.find('=');
    if (sign == std::string::npos || sign == 0) {
      return std::nullopt;
    }
    object.key(std::string_view(assignment).substr(0, sign)) += json_of(std::string_view(assignment).substr(sign + 1));
  }
  object.close();
  return out;
}

}  // namespace gateway::control
