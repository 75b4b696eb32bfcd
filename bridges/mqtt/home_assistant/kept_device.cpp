// What a broker keeps of the gateway's last life, or what somebody else put there.

#include <algorithm>
#include <boost/json/parse.hpp>

#include "bridges/mqtt/home_assistant/device.h"
#include "bridges/mqtt/home_assistant/entity.h"
#include "bridges/mqtt/home_assistant/prefixes.h"

namespace mqtt::home_assistant {
namespace {

namespace json = boost::json;

// Of a drive with some hundred signals.
constexpr std::size_t kLongestKept = 1024UL * 1024;
constexpr std::size_t kDeepestKept = 8;
constexpr std::size_t kLongestKey = 128;

json::object object_of(std::string_view text) {
  if (text.size() > kLongestKept) {
    return {};
  }
  json::error_code failure;
  json::parse_options options;
  options.max_depth = kDeepestKept;
  const json::value read = json::parse(json::string_view(text.data(), text.size()), failure, {}, options);
  const json::object* const object = failure ? nullptr : read.if_object();
  return object == nullptr ? json::object() : *object;
}

std::string_view text_in(const json::object& object, std::string_view name) {
  const json::value* const found = object.if_contains(name);
  const json::string* const text = found == nullptr ? nullptr : found->if_string();
  return text == nullptr ? std::string_view() : std::string_view(text->data(), text->size());
}

bool is_of_gateway(const json::object& message, std::string_view status) {
  const json::value* const found = message.if_contains("availability");
  const json::array* const list = found == nullptr ? nullptr : found->if_array();
  const json::object* const first = list == nullptr || list->empty() ? nullptr : list->front().if_object();
  return first != nullptr && text_in(*first, "topic") == status;
}

// As we make them: nothing that has to be quoted. One that we never make would cost the whole message at Home
// Assistant.
bool is_of_ours(std::string_view key, std::string_view platform) {
  const bool begins = key.size() > platform.size() && key.size() <= kLongestKey && key.starts_with(platform) &&
                      key[platform.size()] == '_';
  return begins && std::ranges::find(kPlatforms, platform) != kPlatforms.end() &&
         std::ranges::all_of(key, [](char letter) {
           return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '_' ||
                  letter == '-';
         });
}

}  // namespace

std::optional<Entities> read_kept_device(std::string_view message, std::string_view status) {
  const json::object kept = object_of(message);
  if (!is_of_gateway(kept, status)) {
    return std::nullopt;
  }
  Entities entities;
  const json::value* const found = kept.if_contains("components");
  const json::object* const components = found == nullptr ? nullptr : found->if_object();
  if (components == nullptr) {
    return entities;
  }
  for (const auto& [key, value] : *components) {
    const json::object* const component = value.if_object();
    if (component == nullptr || component->size() < 2) {
      continue;  // it removes one
    }
    const std::string_view platform = text_in(*component, "platform");
    if (is_of_ours({key.data(), key.size()}, platform)) {
      entities.emplace(std::string_view(key.data(), key.size()), platform);
    }
  }
  return entities;
}

std::vector<std::string> read_kept_prefixes(std::string_view kept) {
  const json::object object = object_of(kept);
  const json::value* const found = object.if_contains("prefixes");
  const json::array* const list = found == nullptr ? nullptr : found->if_array();
  std::vector<std::string> prefixes;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    if (const json::string* const text = (*list)[i].if_string()) {
      prefixes.emplace_back(text->data(), text->size());
    }
  }
  return prefixes;
}

}  // namespace mqtt::home_assistant
