#include "bridges/text/flat_json.h"

#include <algorithm>
#include <boost/json/basic_parser_impl.hpp>
#include <limits>

#include "bridges/text/json_text.h"

namespace text {
namespace {

namespace json = boost::json;
using canopen::Error;
using canopen::ErrorKind;

// More members than any drive has signals.
constexpr std::size_t kMaxMembers = 1024;

// What Boost.JSON's parser calls while it reads. Returning false with an error code ends the parse there.
class FlatHandler {
 public:
  explicit FlatHandler(std::string_view inner) : inner_(inner) {}

  // Boost.JSON wants these names.  NOLINTBEGIN(readability-identifier-naming)
  static constexpr std::size_t max_object_size = kMaxMembers;
  static constexpr std::size_t max_array_size = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t max_key_size = std::numeric_limits<std::size_t>::max();
  static constexpr std::size_t max_string_size = std::numeric_limits<std::size_t>::max();
  // NOLINTEND(readability-identifier-naming)

  bool on_document_begin(json::error_code&) { return true; }
  bool on_document_end(json::error_code&) { return true; }
  bool on_object_begin(json::error_code& failure) {
    if (open_ == nullptr) {
      open_ = &read_.members;
      return true;
    }
    if (open_ != &read_.members || inner_.empty() || open_->back().first != inner_) {
      return refuse(failure, "an object inside the object");
    }
    open_->pop_back();
    open_ = &read_.inner.emplace();
    return true;
  }
  bool on_object_end(std::size_t, json::error_code&) {
    open_ = &read_.members;  // of the outer object nothing follows
    return true;
  }
  bool on_array_begin(json::error_code& failure) { return refuse(failure, "a list"); }
  bool on_array_end(std::size_t, json::error_code&) { return true; }

  bool on_key_part(json::string_view part, std::size_t, json::error_code&) { return gather(part); }
  bool on_key(json::string_view part, std::size_t, json::error_code& failure) {
    std::string name = take(part);
    if (find_member(*open_, name) != nullptr || (open_ == &read_.members && read_.inner && name == inner_)) {
      return refuse(failure, "\"" + name + "\" twice");
    }
    open_->emplace_back(std::move(name), Scalar{});
    return true;
  }
  bool on_string_part(json::string_view part, std::size_t, json::error_code&) { return gather(part); }
  bool on_string(json::string_view part, std::size_t, json::error_code& failure) {
    return add(Scalar::Kind::string, take(part), failure);
  }
  bool on_number_part(json::string_view part, json::error_code&) { return gather(part); }
  bool on_int64(std::int64_t, json::string_view part, json::error_code& failure) { return add_number(part, failure); }
  bool on_uint64(std::uint64_t, json::string_view part, json::error_code& failure) { return add_number(part, failure); }
  bool on_double(double, json::string_view part, json::error_code& failure) { return add_number(part, failure); }
  bool on_bool(bool value, json::error_code& failure) {
    return add(Scalar::Kind::boolean, value ? "true" : "false", failure);
  }
  bool on_null(json::error_code& failure) { return add(Scalar::Kind::null, "null", failure); }
  bool on_comment_part(json::string_view, json::error_code&) { return true; }
  bool on_comment(json::string_view, json::error_code&) { return true; }

  NestedObject& read() noexcept { return read_; }
  [[nodiscard]] const std::string& refusal() const noexcept { return refusal_; }

 private:
  bool gather(json::string_view part) {
    gathered_.append(part.data(), part.size());
    return true;
  }
  std::string take(json::string_view part) {
    gather(part);
    return std::exchange(gathered_, {});
  }
  bool add_number(json::string_view part, json::error_code& failure) {
    return add(Scalar::Kind::number, take(part), failure);
  }
  bool add(Scalar::Kind kind, std::string text, json::error_code& failure) {
    if (open_ == nullptr) {
      return refuse(failure, "a single value");
    }
    open_->back().second = {kind, std::move(text)};
    return true;
  }
  bool refuse(json::error_code& failure, std::string what) {
    refusal_ = std::move(what);
    refusal_ += ", but one object of single values is wanted";
    failure = json::error::extra_data;  // any error stops the parser
    return false;
  }

  std::string inner_;
  NestedObject read_;
  FlatObject* open_ = nullptr;  ///< What the next member belongs to; null before the object.
  std::string gathered_;
  std::string refusal_;
};

}  // namespace

const Scalar* find_member(const FlatObject& members, std::string_view name) {
  const auto found = std::ranges::find(members, name, &FlatObject::value_type::first);
  return found == members.end() ? nullptr : &found->second;
}

const std::string* find_string(const FlatObject& members, std::string_view name) {
  const Scalar* value = find_member(members, name);
  return value != nullptr && value->kind == Scalar::Kind::string ? &value->text : nullptr;
}

std::optional<canopen::Error> unknown_member(const FlatObject& members, std::initializer_list<std::string_view> known) {
  for (const auto& [name, value] : members) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      std::string list;
      for (const std::string_view each : known) {
        list += list.empty() ? "" : ", ";
        list += each;
      }
      return canopen::Error{
          .kind = canopen::ErrorKind::type,
          .detail = std::string("unknown member \"").append(name).append("\"; known are ").append(list).append(", id")};
    }
  }
  return std::nullopt;
}

std::optional<std::string> echoed_id(const Scalar& id) {
  if (id.kind == Scalar::Kind::number) {
    return id.text;
  }
  if (id.kind != Scalar::Kind::string) {
    return std::nullopt;
  }
  std::string quoted;
  append_quoted(quoted, id.text);
  return quoted;
}

canopen::Result<NestedObject> parse_nested(std::string_view text, std::string_view inner) {
  json::basic_parser<FlatHandler> parser{json::parse_options{}, inner};
  json::error_code failure;
  const std::size_t read = parser.write_some(false, text.data(), text.size(), failure);
  const bool trailing = !failure && text.find_first_not_of(" \t\r\n", read) != std::string_view::npos;
  if (!failure && !trailing) {
    return std::move(parser.handler().read());
  }
  const std::string where = " at character " + std::to_string(read + 1);
  if (!parser.handler().refusal().empty()) {
    return Error{.kind = ErrorKind::type, .detail = parser.handler().refusal() + where};
  }
  const std::string what = trailing ? "more behind the object" : failure.message();
  return Error{.kind = ErrorKind::type, .detail = "not valid JSON" + where + ": " + what};
}

canopen::Result<FlatObject> parse_flat(std::string_view text) {
  canopen::Result<NestedObject> read = parse_nested(text, {});
  if (read.has_error()) {
    return read.error();
  }
  return std::move(read.value().members);
}

}  // namespace text
