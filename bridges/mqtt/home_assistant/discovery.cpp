#include "bridges/mqtt/home_assistant/discovery.h"

#include <algorithm>
#include <utility>

namespace mqtt::home_assistant {
namespace {

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

canopen::TimePoint not_before(const std::optional<canopen::TimePoint>& last, canopen::TimePoint now) {
  return last ? std::max(now, *last + Discovery::kLeast) : now;
}

}  // namespace

Discovery::Discovery(const config::Model& model, const config::Mqtt& settings, const Topics& topics,
                     Leftovers& leftovers, std::string version)
    : model_(&model),
      settings_(settings),
      topics_(topics),
      leftovers_(leftovers),
      version_(std::move(version)),
      node_(node_of(topics.root())),
      prefixes_(settings, topics),
      drives_(model.drives.size()) {
  name_topics();
}

void Discovery::name_topics() {
  for (std::size_t i = 0; !settings_.home_assistant.empty() && i < model_->drives.size(); ++i) {
    topics_of_drives_.emplace(topic_of(settings_.home_assistant, model_->drives[i].name), i);
  }
}

void Discovery::change(const config::Model& model, const process::PlantChange& change, canopen::TimePoint now) {
  model_ = &model;
  std::vector<Told> before = std::exchange(drives_, std::vector<Told>(model.drives.size()));
  const auto topics = std::exchange(topics_of_drives_, {});
  name_topics();
  for (const auto& [topic, index] : topics_of_drives_) {
    Told& drive = drives_[index];
    if (const auto known = topics.find(topic); known != topics.end()) {
      drive = std::move(before[known->second]);
    }
    if (!change.drives[index]) {
      leftovers_.back(topic);
      drive.due = std::max(tell_from_, not_before(drive.last, now + kPause));
    }
  }
  for (const auto& [topic, index] : topics) {
    if (!topics_of_drives_.contains(topic)) {
      leftovers_.gone(topic, now);
    }
  }
}

std::string Discovery::topic_of(std::string_view prefix, std::string_view drive) const {
  return std::string(prefix).append("/device/").append(node_).append("/").append(drive).append("/config");
}

std::string Discovery::birth_topic() const {
  return settings_.home_assistant + "/status";
}

void Discovery::connected(const std::string& broker) {
  broker_ = broker;
  prefixes_.connected(broker);
  for (Told& drive : drives_) {
    drive.due = canopen::kNever;
  }
}

std::vector<Subscription> Discovery::subscriptions() const {
  std::vector<Subscription> wanted;
  if (!settings_.home_assistant.empty()) {
    wanted.push_back({.filter = birth_topic(),
                      .watched = true,
                      .lost = "Home Assistant is not told of the drives again when it starts"});
  }
  for (const std::string& prefix : prefixes_.all()) {
    wanted.push_back({.filter = topic_of(prefix, "+"),
                      .watched = true,
                      .kept = true,
                      .lost = "Drives and signals that are gone stay in Home Assistant"});
  }
  return wanted;
}

void Discovery::granted(std::string_view filter) {
  for (const std::string& prefix : prefixes_.all()) {
    if (topic_of(prefix, "+") == filter) {
      prefixes_.granted(prefix);
    }
  }
}

void Discovery::announced(canopen::TimePoint now) {
  prefixes_.announced(now);
  // A gateway of our name that lives says so by then; later it would have been heard.
  const canopen::TimePoint heard = told_at_.contains(broker_) ? now : leftovers_.settled(now);
  tell_from_ = std::max(heard, now + kPause);
  tell_all_at(tell_from_);
}

void Discovery::tell_all_at(canopen::TimePoint at) {
  for (const auto& [topic, index] : topics_of_drives_) {
    drives_[index].due = at;
  }
}

void Discovery::Told::tell_again_at(canopen::TimePoint at) {
  if (due == canopen::kNever && last) {
    due = at;
  }
}

bool Discovery::heard(const Incoming& message, canopen::TimePoint now) {
  if (!settings_.home_assistant.empty() && message.topic == birth_topic()) {
    for (const auto& [topic, index] : topics_of_drives_) {
      Told& drive = drives_[index];
      if (message.payload == "online") {
        drive.tell_again_at(not_before(drive.last, now));
      }
    }
    return true;
  }
  const auto& all = prefixes_.all();
  const auto prefix =
      std::ranges::find_if(all, [&](const std::string& each) { return matches(topic_of(each, "+"), message.topic); });
  if (prefix == all.end()) {
    return false;
  }
  if (message.retained) {
    kept(*prefix, message, now);
  } else if (Told* const drive = find(message.topic)) {
    // MQTT 3.1.1 sends us what is ours.
    const std::size_t hash = std::hash<std::string>{}(message.payload);
    if (std::ranges::find(drive->hashes, std::optional(hash)) == drive->hashes.end()) {
      written(*drive, now);
    }
  }
  return true;
}

Discovery::Told* Discovery::find(std::string_view topic) {
  const auto found = topics_of_drives_.find(topic);
  return found == topics_of_drives_.end() ? nullptr : &drives_[found->second];
}

void Discovery::written(Told& drive, canopen::TimePoint now) {
  drive.puts_right = true;
  drive.tell_again_at(not_before(drive.last, now));
}

void Discovery::kept(const std::string& prefix, const Incoming& message, canopen::TimePoint now) {
  if (message.payload.empty()) {
    return;
  }
  Told* const drive = find(message.topic);
  const auto entities = read_kept_device(message.payload, topics_.status());
  if (!entities) {
    if (drive != nullptr) {
      written(*drive, now);
    }
    return;
  }
  prefixes_.found(prefix);
  if (drive == nullptr) {
    leftovers_.found(message.topic, now);
    return;
  }
  const std::size_t known = drive->before.size();
  for (const auto& [key, platform] : *entities) {
    if (drive->before.size() < kMostEntities) {
      drive->before.emplace(key, platform);
    }
  }
  if (drive->before.size() > known) {
    drive->tell_again_at(now + kPause);
  }
}

canopen::TimePoint Discovery::next() const {
  if (another_lives_) {
    return canopen::kNever;
  }
  canopen::TimePoint next = prefixes_.next();
  for (const Told& drive : drives_) {
    next = std::min(next, drive.due);
  }
  return next;
}

void Discovery::collect(bool another_lives, canopen::TimePoint now, std::vector<Message>& out) {
  const bool lived = std::exchange(another_lives_, another_lives);
  if (another_lives) {
    prefixes_.keep_all();
    return;
  }
  if (lived) {
    tell_all_at(now + kPause);  // it may have told its own of our drives
  }
  prefixes_.collect(now, out);
  const auto due = std::ranges::find_if(drives_, [now](const Told& drive) { return drive.due <= now; });
  if (due != drives_.end()) {
    tell(static_cast<std::size_t>(due - drives_.begin()), now, out);
  }
}

void Discovery::tell(std::size_t index, canopen::TimePoint now, std::vector<Message>& out) {
  Told& drive = drives_[index];
  const config::Drive& of = model_->drives[index];
  Device device = device_of(of, topics_, index, settings_, version_, drive.before);
  Message message{.topic = topic_of(settings_.home_assistant, of.name),
                  .payload = std::move(device.message),
                  .puts_right = std::exchange(drive.puts_right, false)};
  drive.before.merge(device.entities);
  drive.hashes = {std::hash<std::string>{}(message.payload), drive.hashes[0]};
  drive.last = now;
  drive.due = canopen::kNever;
  told_at_.insert(broker_);
  out.push_back(std::move(message));
}

}  // namespace mqtt::home_assistant
