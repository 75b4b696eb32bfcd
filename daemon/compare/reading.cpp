#include "daemon/compare/reading.h"

#include <array>
#include <boost/json/object.hpp>
#include <boost/json/parse.hpp>
#include <charconv>
#include <string_view>

#include "bridges/text/json_text.h"
#include "canopen/error.h"

namespace gateway::compare {
namespace {

namespace json = boost::json;

// SDO abort codes (CiA 301 table 22): the object cannot be read at all.
constexpr std::string_view kAbsentObject = "0x06020000";
constexpr std::string_view kAbsentSub = "0x06090011";

std::string request_of(const std::string& drive, canopen::ObjectAddress object, std::string_view type) {
  std::string out;
  text::ObjectText request(out);
  request.integer("id", 1);
  request.text("op", "sdo-read");
  request.text("drive", drive);
  request.text("object", canopen::to_string(object));
  request.text("type", type);
  request.close();
  return out;
}

std::string_view text_of(const json::object& answer, std::string_view name) {
  const json::value* const value = answer.if_contains(json::string_view(name.data(), name.size()));
  const json::string* const text = value == nullptr ? nullptr : value->if_string();
  return text == nullptr ? std::string_view() : std::string_view(text->data(), text->size());
}

std::optional<canopen::Raw> number_of(canopen::DataType type, const json::value& value) {
  if (const std::int64_t* const number = value.if_int64()) {
    return canopen::normalise(type, static_cast<canopen::Raw>(*number));
  }
  if (const std::uint64_t* const number = value.if_uint64()) {
    return canopen::normalise(type, *number);
  }
  if (const bool* const truth = value.if_bool()) {
    return *truth ? 1 : 0;
  }
  return std::nullopt;
}

// Hexadecimal digits of the bytes, lowest first: in whatever width the drive has it.
std::optional<canopen::Raw> number_of_bytes(canopen::DataType type, std::string_view digits) {
  std::array<std::uint8_t, 8> bytes{};
  std::size_t count = 0;
  for (; count < bytes.size() && 2 * count + 2 <= digits.size(); ++count) {
    const char* const at = digits.data() + 2 * count;
    if (std::from_chars(at, at + 2, bytes.at(count), 16).ptr != at + 2) {
      return std::nullopt;
    }
  }
  return count == 0 ? std::nullopt : canopen::decode_raw(type, bytes);
}

Reading failed(const json::object& answer) {
  const std::string_view code = text_of(answer, "code");
  const std::string_view abort = text_of(answer, "abort");
  Reading reading{.kind = Reading::Kind::unreadable, .reason = std::string(text_of(answer, "error"))};
  if (code == canopen::name_of(canopen::ErrorKind::timeout) || code == canopen::name_of(canopen::ErrorKind::offline)) {
    reading.kind = Reading::Kind::silent;
  } else if (abort == kAbsentObject || abort == kAbsentSub) {
    reading.kind = Reading::Kind::absent;
  }
  return reading;
}

struct Answer {
  bool came = false;
  json::object members{};
  bool ok = false;
};

Answer ask_for(const Ask& ask, const std::string& request) {
  const std::optional<std::string> line = ask(request);
  if (!line) {
    return {};
  }
  json::error_code wrong;
  json::value read = json::parse(*line, wrong);
  if (wrong || !read.is_object()) {
    return {};
  }
  const json::value* const ok = read.as_object().if_contains("ok");
  const bool good = ok != nullptr && ok->is_bool() && ok->get_bool();
  return {.came = true, .members = std::move(read.as_object()), .ok = good};
}

}  // namespace

Reading read_object(const Ask& ask, const std::string& drive, canopen::ObjectAddress object, canopen::DataType type) {
  Answer answer = ask_for(ask, request_of(drive, object, canopen::name_of(type)));
  const bool other_width =
      answer.came && !answer.ok && text_of(answer.members, "code") == canopen::name_of(canopen::ErrorKind::type);
  if (other_width) {
    answer = ask_for(ask, request_of(drive, object, "bytes"));
  }
  if (!answer.came) {
    return {.kind = Reading::Kind::silent, .reason = "the gateway did not answer"};
  }
  if (!answer.ok) {
    return failed(answer.members);
  }
  const json::value* const value = answer.members.if_contains("value");
  std::optional<canopen::Raw> raw;
  if (value != nullptr) {
    raw = other_width ? number_of_bytes(type, text_of(answer.members, "value")) : number_of(type, *value);
  }
  if (!raw) {
    return {.kind = Reading::Kind::unreadable, .reason = "the answer holds no number"};
  }
  return {.kind = Reading::Kind::value, .raw = *raw};
}

}  // namespace gateway::compare
