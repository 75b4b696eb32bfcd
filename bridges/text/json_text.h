#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

// JSON is written as text, member by member: numbers keep the digits they have on their plain topic (a serializer would
// write 49.97 as 4.997E1), and the state of a drive costs one string.

namespace text {

/// Well-formed UTF-8 (RFC 3629).
[[nodiscard]] bool is_utf8(std::string_view text);

/// A quoted and escaped JSON string. Bytes that are no UTF-8 become U+FFFD each.
void append_quoted(std::string& out, std::string_view text);

/// The shortest digits; false (and nothing appended) for NaN and infinity.
bool append_number(std::string& out, double value);
bool append_number(std::string& out, float value);

/// Writes one JSON object: each call adds a member. A value that is not there is null.
class ObjectText {
 public:
  explicit ObjectText(std::string& out) : out_(out) { out_ += '{'; }
  void close() { out_ += '}'; }

  /// The key only; the caller appends the value.
  std::string& key(std::string_view name);
  void text(std::string_view name, std::optional<std::string_view> value);
  void boolean(std::string_view name, bool value);
  void integer(std::string_view name, std::optional<std::int64_t> value);
  /// The shortest digits that stand for `value`; null for NaN and infinity, too.
  void number(std::string_view name, std::optional<double> value);
  void null(std::string_view name);

 private:
  std::string& out_;
  bool first_ = true;
};

/// Writes a JSON list; `append(out, item)` writes one of its values.
template <class Items, class Append>
void append_list(std::string& out, Items&& items, Append append) {
  out += '[';
  bool first = true;
  for (const auto& item : items) {
    out += first ? "" : ",";
    first = false;
    append(out, item);
  }
  out += ']';
}

}  // namespace text
