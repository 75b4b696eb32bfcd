#include "daemon/http/target.h"

#include <algorithm>
#include <utility>

namespace gateway::http {
namespace {

std::optional<unsigned> digit_of(char c) noexcept {
  if (c >= '0' && c <= '9') {
    return static_cast<unsigned>(c - '0');
  }
  const char lower = static_cast<char>(c | 0x20);
  return lower >= 'a' && lower <= 'f' ? std::optional(static_cast<unsigned>(lower - 'a' + 10)) : std::nullopt;
}

TargetMistake mistake_at(std::size_t position, const std::string& what) {
  return {"byte " + std::to_string(position + 1) + " of the target: " + what};
}

/// A part of the target, which begins `begin` bytes behind its start.
class Decoder {
 public:
  Decoder(std::string_view part, std::size_t begin, bool plus_is_blank)
      : part_(part), begin_(begin), plus_is_blank_(plus_is_blank) {}

  [[nodiscard]] std::optional<TargetMistake> decode(std::string& out) {
    for (std::size_t i = 0; i < part_.size(); ++i) {
      if (part_[i] != '%') {
        out += part_[i] == '+' && plus_is_blank_ ? ' ' : part_[i];
        continue;
      }
      const auto high = i + 1 < part_.size() ? digit_of(part_[i + 1]) : std::nullopt;
      const auto low = i + 2 < part_.size() ? digit_of(part_[i + 2]) : std::nullopt;
      if (!high || !low) {
        return mistake_at(begin_ + i, "behind % stand two hexadecimal digits; write %25 for the sign % itself");
      }
      const unsigned byte = *high * 16 + *low;
      if (byte == 0) {
        return mistake_at(begin_ + i, "%00 stands in no name and no number; leave it out");
      }
      out += static_cast<char>(byte);
      i += 2;
    }
    return std::nullopt;
  }

 private:
  std::string_view part_;
  std::size_t begin_;
  bool plus_is_blank_;
};

std::optional<TargetMistake> decode_query(std::string_view query, std::size_t begin, std::vector<Parameter>& out) {
  while (!query.empty()) {
    const std::string_view pair = query.substr(0, query.find('&'));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    Parameter parameter;
    if (auto mistake = Decoder(pair.substr(0, equals), begin, true).decode(parameter.name)) {
      return mistake;
    }
    const std::size_t value = std::min(equals + 1, pair.size());
    if (auto mistake = Decoder(pair.substr(value), begin + value, true).decode(parameter.value)) {
      return mistake;
    }
    if (!pair.empty()) {
      out.push_back(std::move(parameter));
    }
    const std::size_t used = std::min(pair.size() + 1, query.size());
    query.remove_prefix(used);
    begin += used;
  }
  return std::nullopt;
}

}  // namespace

const std::string* Target::find(std::string_view name) const noexcept {
  const auto found = std::ranges::find(parameters, name, &Parameter::name);
  return found == parameters.end() ? nullptr : &found->value;
}

std::variant<Target, TargetMistake> parse_target(std::string_view text) {
  constexpr std::string_view kScheme = "http://";
  Target target;
  std::size_t begin = 0;
  if (text.starts_with(kScheme)) {
    const std::size_t end = std::min(text.find_first_of("/?", kScheme.size()), text.size());
    target.host = text.substr(kScheme.size(), end - kScheme.size());
    begin = end;
    if (target.host.empty()) {
      return mistake_at(begin, "a host is missing behind http://");
    }
  } else if (!text.starts_with('/')) {
    return mistake_at(0, "it begins with a slash");
  }
  const std::string_view rest = text.substr(begin);
  const std::size_t path_end = std::min(rest.find('?'), rest.size());
  if (auto mistake = Decoder(rest.substr(0, path_end), begin, false).decode(target.path)) {
    return *std::move(mistake);
  }
  if (target.path.empty()) {
    target.path = "/";
  }
  const std::size_t query = std::min(path_end + 1, rest.size());
  if (auto mistake = decode_query(rest.substr(query), begin + query, target.parameters)) {
    return *std::move(mistake);
  }
  return target;
}

}  // namespace gateway::http
