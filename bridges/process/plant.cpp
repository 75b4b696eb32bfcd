#include "bridges/process/plant.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "bridges/alarms/alarm_record.h"
#include "bridges/alarms/bus_findings.h"
#include "bridges/process/observer.h"

namespace process {
class Plant::Body {
 public:
  struct Line {
    BusPort port;
    canopen::BusState state{};
    canopen::BusTroubles troubles{};
    alarms::AlarmRecord alarm{};
    bool told = false;  ///< The bus told its state.
  };

  Body(const boost::asio::any_io_executor& executor, const config::Model& plant_model, std::vector<BusPort> buses)
      : model(plant_model) {
    for (std::size_t i = 0; i < buses.size(); ++i) {
      lines.push_back({.port = std::move(buses[i])});
    }
    for (std::size_t i = 0; i < model.drives.size(); ++i) {
      const config::Drive& drive = model.drives[i];
      drives.push_back(std::make_unique<Drive>(executor, drive, i, *lines[drive.bus].port.bus, observers));
      drives.back()->on_fault_began([this, i](alarms::AlarmKind kind, canopen::TimePoint at) {
        first_out.on_fault({.index = i, .kind = kind}, at, drives[i]->alarm(kind).first);
      });
      drives.back()->on_doubled_change([this, bus = drive.bus] { show(bus); });
    }
  }

  [[nodiscard]] Drive* find(std::string_view name) const noexcept {
    const auto found =
        std::ranges::find(drives, name, [](const auto& drive) -> const std::string& { return drive->model().name; });
    return found == drives.end() ? nullptr : found->get();
  }

  [[nodiscard]] std::vector<alarms::BusFinding> findings(std::size_t bus) const {
    alarms::BusView view{.state = lines[bus].state,
                         .interface = model.buses[bus].interface,
                         .own_node_id = model.buses[bus].node_id,
                         .troubles = lines[bus].troubles,
                         .doubled = {},
                         .other_gateway = other_gateway};
    for (const auto& drive : drives) {
      const canopen::NodeStatus& status = drive->status();
      if (drive->model().bus == bus && status.doubled != canopen::Doubled::no) {
        view.doubled.push_back({.drive = drive->model().name,
                                .node = drive->model().node.node,
                                .proof = status.doubled == canopen::Doubled::proof,
                                .text = status.doubled_text});
      }
    }
    return alarms::bus_findings(view);
  }

  void show(std::size_t bus) {
    alarms::AlarmRecord& alarm = lines[bus].alarm;
    if (!lines[bus].told || !show(findings(bus), lines[bus].state, alarm)) {
      return;
    }
    if (alarm.fault_began()) {
      telling_bus = bus;
      first_out.on_fault({.bus = true, .index = bus}, canopen::Clock::now(), alarm.alarm().first);
      telling_bus.reset();
    }
    tell_bus_alarm(bus);
  }

  /// Reason and severity are those of the worst, the text names all. Where nothing is wrong the text says so.
  static bool show(const std::vector<alarms::BusFinding>& findings, const canopen::BusState& state,
                   alarms::AlarmRecord& alarm) {
    if (findings.empty()) {
      return alarm.show(false, "", std::string(canopen::describe(state.condition)), config::Severity::warning,
                        canopen::wall_now());
    }
    std::string text;
    for (const alarms::BusFinding& finding : findings) {
      text += (text.empty() ? "" : "; ") + finding.text;
    }
    return alarm.show(true, std::string(findings.front().reason), text, findings.front().severity, canopen::wall_now());
  }

  void set_first(const alarms::FaultSource& source, bool first) {
    if (!source.bus) {
      drives[source.index]->set_first(source.kind, first);
    } else if (lines[source.index].alarm.set_first(first, canopen::wall_now()) && telling_bus != source.index) {
      tell_bus_alarm(source.index);
    }
  }

  void tell_bus_alarm(std::size_t bus) const {
    for (Observer* observer : observers) {
      observer->on_bus_alarm(bus);
    }
  }

  const config::Model& model;
  bool other_gateway = false;
  std::vector<Observer*> observers;
  std::vector<Line> lines;
  std::vector<std::unique_ptr<Drive>> drives;
  alarms::FirstOut first_out{[this](const alarms::FaultSource& source, bool first) { set_first(source, first); }};
  std::optional<std::size_t> telling_bus;  ///< Its alarm is told of as soon as its flag is known.
};

Plant::Plant(boost::asio::any_io_executor executor, const config::Model& model, std::vector<BusPort> buses)
    : body_(std::make_unique<Body>(executor, model, std::move(buses))) {}

Plant::~Plant() = default;

void Plant::add(Observer& observer) {
  body_->observers.push_back(&observer);
}

void Plant::start() {
  for (const auto& drive : body_->drives) {
    drive->start();
  }
}

void Plant::close() {
  for (const auto& drive : body_->drives) {
    drive->close();
  }
}

boost::asio::awaitable<void> Plant::stop() {
  for (const auto& drive : body_->drives) {
    co_await drive->stop();
  }
}

const config::Model& Plant::model() const noexcept {
  return body_->model;
}

std::size_t Plant::size() const noexcept {
  return body_->drives.size();
}

Drive& Plant::drive(std::size_t index) noexcept {
  return *body_->drives[index];
}

const Drive& Plant::drive(std::size_t index) const noexcept {
  return *body_->drives[index];
}

Drive* Plant::find(std::string_view name) noexcept {
  return body_->find(name);
}

const Drive* Plant::find(std::string_view name) const noexcept {
  return body_->find(name);
}

std::size_t Plant::online() const noexcept {
  const auto& drives = body_->drives;
  return static_cast<std::size_t>(
      std::count_if(drives.begin(), drives.end(), [](const auto& drive) { return drive->status().online; }));
}

std::size_t Plant::with_alarm() const noexcept {
  const auto& drives = body_->drives;
  return static_cast<std::size_t>(std::count_if(drives.begin(), drives.end(), [](const auto& drive) {
    return drive->has_fault_alarm() || drive->has_warning_alarm();
  }));
}

void Plant::restore_bus_alarm(std::size_t bus, const alarms::Alarm& before) {
  body_->lines[bus].alarm.restore(before);
  if (!before.active) {
    return;
  }
  for (Observer* observer : body_->observers) {
    observer->on_bus_alarm(bus);
  }
}

void Plant::set_bus_state(std::size_t bus, const canopen::BusState& state) {
  Body::Line& line = body_->lines[bus];
  line.state = state;
  line.told = true;
  body_->show(bus);
  for (Observer* observer : body_->observers) {
    observer->on_bus(bus);
  }
}

void Plant::set_bus_troubles(std::size_t bus, const canopen::BusTroubles& troubles) {
  body_->lines[bus].troubles = troubles;
  body_->show(bus);
}

void Plant::set_other_gateway(bool lives) {
  body_->other_gateway = lives;
  for (std::size_t bus = 0; bus < body_->lines.size(); ++bus) {
    body_->show(bus);
  }
}

void Plant::set_bus_record(std::size_t bus, std::string name) {
  if (body_->lines[bus].alarm.set_record(std::move(name))) {
    body_->tell_bus_alarm(bus);
  }
}

const canopen::BusState& Plant::bus_state(std::size_t bus) const noexcept {
  return body_->lines[bus].state;
}

canopen::BusStatistics Plant::bus_statistics(std::size_t bus) const {
  const BusPort& port = body_->lines[bus].port;
  return port.statistics ? port.statistics() : canopen::BusStatistics{};
}

const alarms::Alarm& Plant::bus_alarm(std::size_t bus) const noexcept {
  return body_->lines[bus].alarm.alarm();
}

std::optional<alarms::FaultSource> Plant::first_out() const {
  return body_->first_out.newest_group();
}

void Plant::restore_first_out(const alarms::FaultSource& newest) {
  body_->first_out.restore(newest);
}

std::vector<ActiveAlarm> Plant::active_alarms() const {
  std::vector<ActiveAlarm> active;
  const auto add = [&active](const ActiveAlarm& one) {
    if (one.alarm->known && one.alarm->active) {
      const auto later =
          std::upper_bound(active.begin(), active.end(), one,
                           [](const ActiveAlarm& a, const ActiveAlarm& b) { return a.alarm->since < b.alarm->since; });
      active.insert(later, one);
    }
  };
  for (const auto& drive : body_->drives) {
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      add({.drive = drive.get(), .kind = kind, .alarm = &drive->alarm(kind)});
    }
  }
  for (std::size_t bus = 0; bus < body_->lines.size(); ++bus) {
    add({.bus = bus, .alarm = &bus_alarm(bus)});
  }
  return active;
}

}  // namespace process
