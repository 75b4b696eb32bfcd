#include "bridges/mqtt/topics.h"

#include <algorithm>
#include <utility>

#include "bridges/text/json_text.h"

namespace mqtt {
namespace {

// The longest topic MQTT can carry (MQTT 5 §1.5.4) is 65535 bytes; nobody needs as much.
constexpr std::size_t kMaxTopic = 1024;

// The levels of a topic; an empty level stays one.
std::vector<std::string_view> levels_of(std::string_view topic) {
  std::vector<std::string_view> levels;
  for (;;) {
    const std::size_t slash = topic.find('/');
    levels.push_back(topic.substr(0, slash));
    if (slash == std::string_view::npos) {
      return levels;
    }
    topic.remove_prefix(slash + 1);
  }
}

// What stands behind `parent/`.
std::optional<std::string_view> below(std::string_view topic, std::string_view parent) {
  if (topic.size() <= parent.size() || !topic.starts_with(parent) || topic[parent.size()] != '/') {
    return std::nullopt;
  }
  return topic.substr(parent.size() + 1);
}

bool is_publishable(std::string_view topic) {
  if (topic.empty() || topic.size() > kMaxTopic || topic.front() == '$' || !text::is_utf8(topic)) {
    return false;
  }
  return std::none_of(topic.begin(), topic.end(), [](char character) {
    return character == '+' || character == '#' || static_cast<unsigned char>(character) < 0x20 || character == 0x7F;
  });
}

DriveTopics topics_of(const config::Drive& drive, const std::string& root) {
  const std::string parent = root + "/" + drive.name + "/";
  DriveTopics topics;
  topics.root = root + "/" + drive.name;
  topics.status = parent + "status";
  topics.state = parent + "state";
  topics.control = parent + "control";
  topics.sdo_response = parent + "sdo/response";
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    topics.alarms.at(static_cast<std::size_t>(kind)) = parent + "alarm/" + std::string(alarms::name_of(kind));
  }
  for (const config::Signal& signal : drive.signals) {
    topics.signals.push_back(parent + signal.name);
  }
  return topics;
}

}  // namespace

std::string status_topic(std::string_view base, std::string_view gateway) {
  return std::string(base) + "/" + std::string(gateway) + "/status";
}

bool matches(std::string_view filter, std::string_view topic) {
  if (topic.starts_with('$') && !filter.starts_with('$')) {
    return false;  // MQTT 5 §4.7.2
  }
  for (;;) {
    const std::string_view wanted = filter.substr(0, filter.find('/'));
    const std::string_view level = topic.substr(0, topic.find('/'));
    if (wanted == "#") {
      return true;
    }
    if (wanted != "+" && wanted != level) {
      return false;
    }
    const bool last_wanted = wanted.size() == filter.size();
    filter.remove_prefix(std::min(wanted.size() + 1, filter.size()));
    if (level.size() == topic.size()) {
      return last_wanted || filter == "#";  // `a/#` stands for `a`, too
    }
    if (last_wanted) {
      return false;
    }
    topic.remove_prefix(level.size() + 1);
  }
}

Topics::Topics(const config::Model& model, const config::Mqtt& settings, std::string_view gateway)
    : base_(settings.base),
      answers_(settings.answers),
      root_(base_ + "/" + std::string(gateway)),
      status_(status_topic(base_, gateway)),
      health_(root_ + "/health"),
      info_(root_ + "/info"),
      home_assistant_(root_ + "/home_assistant"),
      result_(root_ + "/result"),
      alarms_(root_ + "/alarms") {
  change(model, {.drives = process::PlantChange::From(model.drives.size()),
                 .buses = process::PlantChange::From(model.buses.size())});
}

void Topics::change(const config::Model& model, const process::PlantChange& change) {
  drives_ = process::realigned(std::move(drives_), change.drives, [&](std::size_t i) {
    return std::make_unique<const DriveTopics>(topics_of(model.drives[i], root_));
  });
  bus_alarms_ = process::realigned(std::move(bus_alarms_), change.buses, [&](std::size_t i) {
    return std::make_unique<const std::string>(root_ + "/bus/" + model.buses[i].name + "/alarm");
  });
}

std::vector<Subscription> Topics::command_subscriptions() const {
  // `+/+/set` holds `nmt/set` too. None of these overlap, so no command comes twice.
  return {{root_ + "/+/set", 1},
          {root_ + "/+/+/set", 1},
          {root_ + "/+/sdo/request", 1},
          {root_ + "/+/control/alive", 1},
          {root_ + "/stop", 1}};
}

Subscription Topics::tree_subscription() const {
  // With QoS 0 nothing of it waits in the broker when it is given back.
  return {.filter = root_ + "/#", .qos = 0, .bulk = true};
}

std::vector<Subscription> Topics::watched_subscriptions() const {
  std::vector<Subscription> watched{
      {.filter = status_, .watched = true, .own_too = true}, {.filter = root_ + "/+/status", .watched = true},
      {.filter = root_ + "/bus/+/alarm", .watched = true},   {.filter = alarms_, .watched = true},
      {.filter = health_, .watched = true, .kept = true},    {.filter = info_, .watched = true}};
  // Not `+/alarm/+`: that overlaps with a command's filter, so that both would come twice.
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    watched.push_back({.filter = root_ + "/+/alarm/" + std::string(alarms::name_of(kind)), .watched = true});
  }
  return watched;
}

std::string_view Topics::below_root(std::string_view topic) const {
  return below(topic, root_).value_or(std::string_view());
}

std::optional<Route> Topics::route(std::string_view topic) const {
  const auto rest = below(topic, root_);
  if (!rest) {
    return std::nullopt;
  }
  const std::vector<std::string_view> levels = levels_of(*rest);
  if (*rest == "stop") {
    return Route{Route::Kind::stop_all, {}, {}};
  }
  if (levels.size() == 2 && levels[1] == "set") {
    return Route{Route::Kind::set_drive, levels[0], {}};
  }
  if (*rest == "alarms") {
    return Route{Route::Kind::alarm, {}, {}};
  }
  if (*rest == "health" || *rest == "info") {
    return Route{Route::Kind::life, {}, {}};
  }
  if (*rest == "status") {
    return Route{Route::Kind::status, {}, {}};
  }
  if (levels.size() == 2 && levels[1] == "status") {
    return Route{Route::Kind::status, levels[0], {}};
  }
  if (levels.size() != 3) {
    return std::nullopt;
  }
  if (levels[2] == "set") {
    const Route::Kind kind = levels[1] == "nmt" ? Route::Kind::nmt : Route::Kind::set_signal;
    return Route{kind, levels[0], levels[1]};
  }
  if (levels[1] == "sdo" && levels[2] == "request") {
    return Route{Route::Kind::sdo, levels[0], {}};
  }
  if (levels[1] == "control" && levels[2] == "alive") {
    return Route{Route::Kind::alive, levels[0], {}};
  }
  if (levels[1] == "alarm" || (levels[0] == "bus" && levels[2] == "alarm")) {
    return Route{Route::Kind::alarm, levels[0], {}};
  }
  return std::nullopt;
}

bool Topics::refused_as_response(std::string_view topic) const {
  if (!is_publishable(topic)) {
    return true;
  }
  if (topic == base_ || below(topic, base_)) {
    return true;
  }
  return answers_ && std::none_of(answers_->begin(), answers_->end(),
                                  [topic](const std::string& filter) { return matches(filter, topic); });
}

}  // namespace mqtt
