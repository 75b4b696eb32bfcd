#include "bridges/mqtt/home_assistant/prefixes.h"

#include <algorithm>

#include "bridges/text/json_text.h"

namespace mqtt::home_assistant {
namespace {

constexpr std::size_t kLongestPrefix = 256;

// What the broker keeps may be of anybody.
bool is_prefix(std::string_view text) {
  return !text.empty() && text.size() <= kLongestPrefix && text.front() != '$' && text::is_utf8(text) &&
         std::ranges::none_of(text, [](char letter) {
           return letter == '+' || letter == '#' || static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F;
         });
}

}  // namespace

Prefixes::Prefixes(const config::Mqtt& settings, const Topics& topics) : settings_(settings), topics_(topics) {
  connected({});
}

void Prefixes::connected(const std::string& broker) {
  here_ = &places_[broker];
  if (!settings_.home_assistant.empty()) {
    here_->prefixes.insert(settings_.home_assistant);
  }
  granted_.clear();
  found_.clear();
  due_ = canopen::kNever;
  said_ = false;
}

void Prefixes::read(std::string_view kept) {
  here_->kept = !kept.empty();
  for (const std::string& prefix : read_kept_prefixes(kept)) {
    if (is_prefix(prefix) && !matches(settings_.base + "/#", prefix) && here_->prefixes.size() < kMost) {
      here_->prefixes.insert(prefix);
    }
  }
}

void Prefixes::announced(canopen::TimePoint now) {
  announced_ = now;
  due_ = now;
}

void Prefixes::collect(canopen::TimePoint now, std::vector<Message>& out) {
  if (now < due_) {
    return;
  }
  due_ = said_ ? canopen::kNever : announced_ + kPatience;
  std::size_t gone = 0;
  if (said_) {
    gone = std::erase_if(here_->prefixes, [this](const std::string& prefix) {
      return prefix != settings_.home_assistant && granted_.contains(prefix) && !found_.contains(prefix);
    });
  }
  const bool empty = here_->prefixes.empty();
  const bool says = said_ ? gone > 0 : !empty || here_->kept;
  said_ = true;
  if (!says) {
    return;
  }
  Message message{.topic = topics_.home_assistant()};
  if (!empty) {
    text::ObjectText object(message.payload);
    text::append_list(object.key("prefixes"), here_->prefixes,
                      [](std::string& list, std::string_view prefix) { text::append_quoted(list, prefix); });
    object.close();
  }
  here_->kept = !empty;
  out.push_back(std::move(message));
}

}  // namespace mqtt::home_assistant
