#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/clock.h"
#include "canopen/object.h"
#include "config/schema/complaint.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {

/// How a value is written: what the manual says of it, how it is checked and read, and how a default is shown.
template <class T>
struct Form {
  std::string type;  ///< As the manual names it: `integer 1..127`.
  /// The value; or nothing, and what is wrong goes to the complaint.
  std::function<std::optional<T>(const Node&, const Complaint&)> read;
  std::function<std::string(const T&)> show;  ///< Empty where no default is worth showing.
};

/// What an object of milliseconds in 16 bits holds (0x1016, 0x1017, event timers).
inline constexpr std::chrono::milliseconds kLongest16(65535);

/// A Modbus unit as it is stated; nothing: `"none"`.
struct Unit {
  std::optional<std::uint8_t> number;
};

/// True, or a complaint that the value is of another kind. `example` is how such a value looks, may be empty.
bool expect(const Node& node, NodeKind kind, const Complaint& complain, std::string_view example = {});

/// The same of a list.
bool expect_list(const Node& node, const Complaint& complain);

[[nodiscard]] Form<bool> boolean();
/// Where it has a unit: `integer(1, 9, "bit/s", "250000")`.
[[nodiscard]] Form<std::int64_t> integer(std::int64_t min, std::int64_t max, std::string_view unit = {},
                                         std::string_view example = {});
/// Any integer; shown without a range.
[[nodiscard]] Form<std::int64_t> any_integer(std::int64_t min = INT64_MIN);
/// An integer or a number, finite.
[[nodiscard]] Form<double> number();
/// The same within a range.
[[nodiscard]] Form<double> number(double min, double max);
/// Free text of at most 200 bytes without control characters.
[[nodiscard]] Form<std::string> text();
/// The same of at least one byte.
[[nodiscard]] Form<std::string> filled_text();
/// [A-Za-z0-9_-]{1,32}
[[nodiscard]] Form<std::string> name();
struct DurationRule {
  canopen::Duration min;
  canopen::Duration max;
  bool zero = false;           ///< `0s` is allowed below `min`, too.
  bool whole_ms = false;       ///< Whole milliseconds only: what objects of CiA 301 hold.
  std::string_view without{};  ///< Why `0s` is refused, where people will try it.
};
/// A string with unit.
[[nodiscard]] Form<canopen::Duration> duration(DurationRule rule);
/// Bytes, as a string with unit: `"50MB"`.
[[nodiscard]] Form<std::uint64_t> size(std::uint64_t min, std::uint64_t max);
struct PathRule {
  std::size_t longest = 200;         ///< Bytes.
  std::string_view why_no_longer{};  ///< Of that limit, for people: ` (a socket's address)`.
  bool may_be_empty = false;
};
/// An absolute path without control characters.
[[nodiscard]] Form<std::string> absolute_path(PathRule rule);
[[nodiscard]] Form<canopen::ObjectAddress> object();
[[nodiscard]] Form<canopen::DataType> data_type();
[[nodiscard]] Form<std::pair<canopen::ObjectAddress, canopen::DataType>> mapped_object();
[[nodiscard]] Form<CobId> cob_id();
[[nodiscard]] Form<Unit> unit();
/// A text of 1 to 200 bytes without control characters.
[[nodiscard]] std::optional<std::string> read_short_text(const Node& node, const Complaint& complain);
/// True where every key of a table is a number of the range. Complains of one that stands there twice, too.
bool check_numbers(const Node& node, std::int64_t min, std::int64_t max, const Complaint& complain);
/// A table of number -> text.
[[nodiscard]] Form<std::map<std::int64_t, std::string>> numbered_texts(std::int64_t min, std::int64_t max);

/// The positions of `texts` as a value: what choice() is made of.
[[nodiscard]] Form<std::size_t> one_of(std::vector<std::string_view> texts);

/// One of a few words, each with its value.
template <class E>
[[nodiscard]] Form<E> choice(std::vector<std::pair<std::string_view, E>> choices) {
  std::vector<std::string_view> texts;
  for (const auto& [text, value] : choices) {
    texts.push_back(text);
  }
  Form<std::size_t> position = one_of(std::move(texts));
  return {.type = position.type,
          .read = [choices, read = std::move(position.read)](const Node& node,
                                                             const Complaint& complain) -> std::optional<E> {
            const auto at = read(node, complain);
            return at.has_value() ? std::optional(choices[*at].second) : std::nullopt;
          },
          .show =
              [choices](const E& value) {
                for (const auto& [text, known] : choices) {
                  if (known == value) {
                    return std::string(text);
                  }
                }
                return std::string();
              }};
}

/// A table of number -> something; of two spellings of one number the last counts. With one wrong entry there is none.
template <class T>
[[nodiscard]] Form<std::map<std::int64_t, T>> numbered(
    std::string type, std::int64_t min, std::int64_t max,
    std::function<std::optional<T>(const Node&, const Complaint&)> read) {
  return {.type = std::move(type),
          .read = [=](const Node& node, const Complaint& complain) -> std::optional<std::map<std::int64_t, T>> {
            bool good = check_numbers(node, min, max, complain);
            std::map<std::int64_t, T> values;
            for (const Entry& entry : node.entries) {
              const auto number = parse_integer(entry.key);
              // Where the key is none, the value may be as it should: `{ run = 15 }`.
              auto value = number.has_value() ? read(entry.value, complain.at(entry.key)) : std::nullopt;
              good = good && value.has_value();
              if (good) {
                values.insert_or_assign(*number, *std::move(value));
              }
            }
            return good ? std::optional(std::move(values)) : std::nullopt;
          },
          .show = {}};
}

/// A list of such values; `type` as the manual names it: `list of strings`. With one wrong item there is none.
template <class T>
[[nodiscard]] Form<std::vector<T>> list(std::string type, Form<T> item) {
  return {.type = std::move(type),
          .read = [read = item.read](const Node& node, const Complaint& complain) -> std::optional<std::vector<T>> {
            if (!expect_list(node, complain)) {
              return std::nullopt;
            }
            constexpr std::size_t kMost = 1000;
            if (node.items.size() > kMost) {
              complain.value(node.place, "has more than 1000 entries");
              return std::nullopt;
            }
            std::vector<T> values;
            bool good = true;
            for (const Node& each : node.items) {
              auto value = read(each, complain);
              good = good && value.has_value();
              if (value.has_value()) {
                values.push_back(*std::move(value));
              }
            }
            return good ? std::optional(std::move(values)) : std::nullopt;
          },
          .show =
              [show = item.show](const std::vector<T>& values) {
                std::string shown;
                for (const T& value : values) {
                  shown += (shown.empty() ? "\"" : ", \"") + show(value) + "\"";
                }
                return "[" + shown + "]";
              }};
}

}  // namespace config
