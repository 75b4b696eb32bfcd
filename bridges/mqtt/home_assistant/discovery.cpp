#include "bridges/mqtt/home_assistant/discovery.h"

#include <algorithm>
#include <utility>

#include "bridges/text/json_text.h"

namespace mqtt::home_assistant {
namespace {

constexpr std::size_t kLongestPrefix = 256;

std::string node_of(std::string root) {
  std::ranges::replace_if(
      root,
      [](char letter) {
        return !((letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                 (letter >= '0' && letter <= '9') || letter == '-');
      },
      '_');
  return root;
}

// What the broker keeps may be of anybody.
bool is_prefix(std::string_view text) {
  return !text.empty() && text.size() <= kLongestPrefix && text.front() != '$' && text::is_utf8(text) &&
         std::ranges::none_of(text, [](char letter) {
           return letter == '+' || letter == '#' || static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F;
         });
}

}  // namespace

Discovery::Discovery(const config::Model& model, const config::Mqtt& settings, const Topics& topics,
                     Leftovers& leftovers, std::string version)
    : model_(model),
      settings_(settings),
      topics_(topics),
      leftovers_(leftovers),
      version_(std::move(version)),
      node_(node_of(topics.root())),
      before_(model.drives.size()) {
  if (!settings.home_assistant.empty()) {
    prefixes_.insert(settings.home_assistant);
  }
}

std::string Discovery::topic_of(std::string_view prefix, std::string_view drive) const {
  return std::string(prefix).append("/device/").append(node_).append("/").append(drive).append("/config");
}

std::string Discovery::birth_topic() const {
  return settings_.home_assistant + "/status";
}

std::vector<Subscription> Discovery::subscriptions() const {
  std::vector<Subscription> wanted;
  if (!settings_.home_assistant.empty()) {
    wanted.push_back({.filter = birth_topic(),
                      .watched = true,
                      .lost = "Home Assistant is not told of the drives again when it starts"});
  }
  for (const std::string& prefix : prefixes_) {
    wanted.push_back({.filter = topic_of(prefix, "+"),
                      .watched = true,
                      .kept = true,
                      .lost = "Drives and signals that are gone stay in Home Assistant"});
  }
  return wanted;
}

void Discovery::info_kept(std::string_view info) {
  const std::string prefix = read_kept_prefix(info);
  if (is_prefix(prefix) && !matches(settings_.base + "/#", prefix) && prefixes_.size() < kMostPrefixes) {
    prefixes_.insert(prefix);
  }
}

void Discovery::announced(canopen::TimePoint now) {
  due_ = canopen::kNever;
  tell_all_at(now + kPause);
}

bool Discovery::heard(const Incoming& message, canopen::TimePoint now) {
  if (!settings_.home_assistant.empty() && message.topic == birth_topic()) {
    if (message.payload == "online" && due_ == canopen::kNever) {
      tell_all_at(told_ + kLeast > now ? told_ + kLeast : now);
    }
    return true;
  }
  const bool ours = std::ranges::any_of(
      prefixes_, [&](const std::string& prefix) { return matches(topic_of(prefix, "+"), message.topic); });
  if (ours && message.retained) {
    kept(message, now);
  }
  return ours;
}

void Discovery::kept(const Incoming& message, canopen::TimePoint now) {
  const auto entities = read_kept_device(message.payload, topics_.status());
  if (!entities) {
    return;  // emptied, or of somebody else
  }
  const auto drive = std::ranges::find_if(model_.drives, [&](const config::Drive& each) {
    return !settings_.home_assistant.empty() && topic_of(settings_.home_assistant, each.name) == message.topic;
  });
  if (drive == model_.drives.end()) {
    leftovers_.found(message.topic, now);
    return;
  }
  const auto index = static_cast<std::size_t>(drive - model_.drives.begin());
  const std::size_t known = before_[index].size();
  for (const auto& [key, platform] : *entities) {
    if (before_[index].size() < kMostEntities) {
      before_[index].emplace(key, platform);
    }
  }
  const bool told_already = due_ == canopen::kNever || drive_ > index;
  if (before_[index].size() > known && told_already) {
    tell_all_at(now + kPause);
  }
}

void Discovery::tell_all_at(canopen::TimePoint at) {
  if (!settings_.home_assistant.empty() && !model_.drives.empty()) {
    drive_ = 0;
    due_ = std::min(due_, at);
  }
}

void Discovery::collect(canopen::TimePoint now, std::vector<Message>& out) {
  if (now < due_) {
    return;
  }
  const config::Drive& drive = model_.drives[drive_];
  out.push_back({.topic = topic_of(settings_.home_assistant, drive.name),
                 .payload = device_of(drive, topics_, drive_, settings_, version_, before_[drive_]).message});
  if (++drive_ == model_.drives.size()) {
    drive_ = 0;
    told_ = now;
    due_ = canopen::kNever;
  }
}

}  // namespace mqtt::home_assistant
