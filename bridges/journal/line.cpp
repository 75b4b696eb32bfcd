#include "bridges/journal/line.h"

#include <algorithm>
#include <array>
#include <boost/json/monotonic_resource.hpp>
#include <boost/json/parse.hpp>
#include <chrono>
#include <cstdio>

#include "bridges/journal/sha256.h"
#include "bridges/text/timestamp.h"

namespace journal {
namespace {

namespace json = boost::json;

std::optional<std::uint64_t> count_of(const json::object& object, std::string_view key) {
  const json::value* const value = object.if_contains(key);
  if (value == nullptr || !value->is_int64() || value->get_int64() < 0) {
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(value->get_int64());
}

std::optional<std::string> text_of(const json::object& object, std::string_view key) {
  const json::value* const value = object.if_contains(key);
  if (value == nullptr || !value->is_string()) {
    return std::nullopt;
  }
  return std::string(value->get_string());
}

bool is_hash(std::string_view text) {
  return text.size() == Sha256::kHexLength && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::string seconds_text(canopen::TimePoint time) {
  const auto all = std::chrono::duration_cast<std::chrono::microseconds>(time.time_since_epoch()).count();
  std::array<char, 40> text{};
  const int size = std::snprintf(text.data(), text.size(), "%lld.%06lld", static_cast<long long>(all / 1'000'000),
                                 static_cast<long long>(all % 1'000'000));
  return {text.data(), static_cast<std::size_t>(size)};
}

}  // namespace

std::optional<Line> parse_line(std::string_view text) {
  if (text.size() > kMaxLine || !text.starts_with('{')) {
    return std::nullopt;
  }
  json::error_code failure;
  json::monotonic_resource memory;
  const json::value value = json::parse(json::string_view(text.data(), text.size()), failure, &memory);
  if (failure || !value.is_object()) {
    return std::nullopt;
  }
  const json::object& object = value.get_object();
  const auto n = count_of(object, "n");
  auto prev = text_of(object, "prev");
  auto phase = text_of(object, "phase");
  if (!n || *n == 0 || !prev || !is_hash(*prev) || !phase) {
    return std::nullopt;
  }
  return Line{.n = *n,
              .ts = text_of(object, "ts").value_or(""),
              .phase = *std::move(phase),
              .prev = *std::move(prev),
              .bytes = count_of(object, "bytes").value_or(0),
              .sha256 = text_of(object, "sha256").value_or(""),
              .count = count_of(object, "count").value_or(0)};
}

std::string make_line(const Entry& entry, std::uint64_t n, std::string_view prev) {
  std::string line = "{\"n\":" + std::to_string(n);
  line += ",\"ts\":\"" + text::timestamp(entry.wall) + "\",\"mono\":" + seconds_text(entry.at) + ',';
  line += entry.members;
  line += ",\"prev\":\"";
  line += prev;
  line += "\"}";
  return line;
}

}  // namespace journal
