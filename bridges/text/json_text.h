#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// JSON is written as text, member by member: numbers keep the digits they have on their plain topic (a serializer would
// write 49.97 as 4.997E1), and the state of a drive costs one string.

namespace text {

/// A quoted and escaped JSON string. Bytes that are no UTF-8 become U+FFFD.
void append_quoted(std::string& out, std::string_view text);

/// Writes one JSON object: each call adds a member.
class ObjectText {
 public:
  explicit ObjectText(std::string& out) : out_(out) { out_ += '{'; }
  void close() { out_ += '}'; }

  /// The key only; the caller appends the value.
  std::string& key(std::string_view name);
  void text(std::string_view name, std::string_view value);
  void boolean(std::string_view name, bool value);
  void integer(std::string_view name, std::int64_t value);
  void null(std::string_view name);
  /// The shortest digits that stand for `value`; null for NaN, infinity and nothing.
  void number(std::string_view name, std::optional<double> value);

 private:
  std::string& out_;
  bool first_ = true;
};

/// Appends a comma unless it is the first.
void append_separator(std::string& out, bool& first);
/// The shortest digits; false (and nothing appended) for NaN and infinity.
bool append_number(std::string& out, double value);
bool append_number(std::string& out, float value);

}  // namespace text
