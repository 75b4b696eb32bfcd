#include "bridges/mqtt/leftovers.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "bridges/alarms/alarm.h"
#include "bridges/mqtt/expiry.h"

namespace mqtt {
namespace {

// Where the log names topics, so many bytes of them stand in one line.
constexpr std::size_t kLine = 1000;

/// A topic of the forms in which we publish of drives and buses.
struct Form {
  std::string_view drive{};  ///< Empty: of a bus.
  bool of_a_drive = false;   ///< Only a drive has such a topic.
};

// As the configuration names signals; `status`, `state` and `control` are like them. What comes by the others, or below
// them, is no value.
bool is_of_a_value(std::string_view name) {
  constexpr std::array<std::string_view, 5> kOthers{"set", "nmt", "sdo", "alarm", "history"};
  const auto fits = [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '_';
  };
  return !name.empty() && name.front() >= 'a' && name.front() <= 'z' && std::ranges::all_of(name, fits) &&
         std::ranges::find(kOthers, name) == kOthers.end();
}

bool is_alarm(std::string_view name) {
  return std::ranges::any_of(alarms::kAlarmKinds, [name](alarms::AlarmKind kind) {
    return name.starts_with("alarm/") && name.substr(name.find('/') + 1) == alarms::name_of(kind);
  });
}

std::optional<Form> form_of(std::string_view below_root) {
  const std::size_t slash = below_root.find('/');
  if (slash == std::string_view::npos) {
    return std::nullopt;  // `status`, `info` and their like are of every gateway
  }
  const std::string_view owner = below_root.substr(0, slash);
  const std::string_view rest = below_root.substr(slash + 1);
  if (owner == "bus") {
    const std::size_t second = rest.find('/');
    const bool alarm = second != 0 && second != std::string_view::npos && rest.substr(second) == "/alarm";
    return alarm ? std::optional(Form{}) : std::nullopt;
  }
  if (owner.empty() || !(is_alarm(rest) || is_of_a_value(rest))) {
    return std::nullopt;
  }
  return Form{.drive = owner, .of_a_drive = rest == "status" || is_alarm(rest)};
}

}  // namespace

Leftovers::Leftovers(const config::Model& model, const config::Mqtt& settings, const Topics& topics)
    : settings_(settings), topics_(topics), patience_(lifetime(settings) / 3 + std::chrono::seconds(5)) {
  note_published(model);
}

void Leftovers::note_published(const config::Model& model) {
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    const config::Drive& drive = model.drives[i];
    const DriveTopics& of_drive = topics_.drive(i);
    drives_.insert(drive.name);
    published_.insert({of_drive.status, of_drive.control});
    published_.insert(of_drive.alarms.begin(), of_drive.alarms.end());
    if (settings_.state) {
      published_.insert(of_drive.state);
    }
    for (std::size_t signal = 0; settings_.signals && signal < drive.signals.size(); ++signal) {
      if (config::readable(drive.signals[signal].access)) {
        published_.insert(of_drive.signals[signal]);
      }
    }
  }
  for (std::size_t bus = 0; bus < model.buses.size(); ++bus) {
    published_.insert(topics_.bus_alarm(bus));
  }
}

void Leftovers::change(const config::Model& model, canopen::TimePoint now) {
  const auto before = std::exchange(published_, {});
  note_published(model);
  for (const std::string& topic : published_) {
    back(topic);
  }
  for (const std::string& topic : before) {
    if (!published_.contains(topic)) {
      gone(topic, now);
    }
  }
}

void Leftovers::gone(const std::string& topic, canopen::TimePoint now) {
  for (auto& [place, found] : places_) {
    if (found.kept.size() < kMost) {
      found.kept.emplace(topic, std::string());
    }
  }
  come(now);
}

void Leftovers::back(const std::string& topic) {
  for (auto& [place, found] : places_) {
    found.kept.erase(topic);
    found.emptied.erase(topic);
  }
}

void Leftovers::lost(canopen::TimePoint now) {
  if (now - here_->emptied_at < kArrives) {
    here_->kept.merge(here_->emptied);
  }
  here_->emptied.clear();
  announced_.reset();
  due_ = canopen::kNever;
}

void Leftovers::connected(const std::string& place) {
  here_ = &places_[place];
  announced_.reset();
  due_ = canopen::kNever;
}

void Leftovers::heard(const Incoming& message) {
  if (!message.retained || message.payload.empty()) {
    return;
  }
  if (message.topic == topics_.status()) {
    here_->in_use = message.payload == "online";
    return;
  }
  const auto form = form_of(topics_.below_root(message.topic));
  if (!form) {
    return;
  }
  if (form->of_a_drive) {
    drives_.emplace(form->drive);
  }
  if (!published_.contains(message.topic) && here_->kept.size() < kMost) {
    here_->kept.emplace(message.topic, form->drive);
  }
}

void Leftovers::announced(canopen::TimePoint now) {
  std::erase_if(here_->kept,
                [this](const auto& each) { return !each.second.empty() && !drives_.contains(each.second); });
  announced_ = now;
  if (!here_->kept.empty()) {
    due_ = here_->in_use ? now + patience_ : now;
  }
}

void Leftovers::found(const std::string& topic, canopen::TimePoint now) {
  if (here_->kept.size() < kMost) {
    here_->kept.emplace(topic, std::string());
  }
  come(now);
}

void Leftovers::come(canopen::TimePoint now) {
  if (announced_) {
    due_ = std::min(due_, here_->in_use ? std::max(now, *announced_ + patience_) : now);
  }
}

void Leftovers::collect(bool another_lives, canopen::TimePoint now, std::vector<Message>& out, const Notice& notice) {
  if (here_->kept.empty() || (now < due_ && !another_lives)) {
    return;
  }
  due_ = canopen::kNever;
  auto found = std::exchange(here_->kept, {});
  if (another_lives) {
    notice(Level::warning, "MQTT: " + std::to_string(found.size()) +
                               " topics that this gateway does not publish are left as they are, because another "
                               "gateway of its name lives");
    return;
  }
  std::string line;
  const auto say = [&line, &notice] { notice(Level::info, "MQTT: emptied, as nobody publishes it any more:" + line); };
  for (const auto& [topic, drive] : found) {
    out.push_back({.topic = topic});
    line += " " + topic;
    if (line.size() > kLine) {
      say();
      line.clear();
    }
  }
  if (!line.empty()) {
    say();
  }
  here_->emptied.merge(found);
  here_->emptied_at = now;
}

}  // namespace mqtt
