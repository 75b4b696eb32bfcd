#include "bridges/process/plant_body.h"

#include <algorithm>
#include <string>
#include <utility>

#include "bridges/process/observer.h"

namespace process {
namespace {

/// Reason and severity are those of the worst, the text names all. Where nothing is wrong the text says so.
bool show_findings(const std::vector<alarms::BusFinding>& findings, const canopen::BusState& state,
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

}  // namespace

Plant::Body::Body(const boost::asio::any_io_executor& for_drives, std::shared_ptr<const config::Model> plant_model,
                  std::vector<BusPort> buses)
    : executor(for_drives), model(std::move(plant_model)) {
  for (BusPort& port : buses) {
    lines.push_back({.port = std::move(port)});
  }
  for (std::size_t i = 0; i < model->drives.size(); ++i) {
    drives.push_back(make_drive(i));
  }
}

Plant::Body::Place Plant::Body::make_drive(std::size_t index) {
  const config::Drive& settings = model->drives[index];
  auto drive = std::make_unique<Drive>(executor, settings, index, *lines[settings.bus].port.bus, observers);
  Drive* const made = drive.get();
  made->set_journal(journal);
  made->on_fault_began([this, made](alarms::AlarmKind kind, canopen::TimePoint at) {
    first_out.on_fault({.index = made->index(), .kind = kind}, at, made->alarm(kind).first);
  });
  made->on_doubled_change([this, made] { show(made->bus()); });
  return {model, std::move(drive)};
}

Drive* Plant::Body::find(std::string_view name) const noexcept {
  const auto found = std::ranges::find(
      drives, name, [](const Place& place) -> const std::string& { return place.drive->model().name; });
  return found == drives.end() ? nullptr : found->drive.get();
}

std::vector<alarms::BusFinding> Plant::Body::findings(std::size_t bus) const {
  alarms::BusView view{.state = lines[bus].state,
                       .interface = model->buses[bus].interface,
                       .own_node_id = model->buses[bus].node_id,
                       .troubles = lines[bus].troubles,
                       .doubled = {},
                       .other_gateway = other_gateway};
  for (const Place& place : drives) {
    const Drive& drive = *place.drive;
    const canopen::NodeStatus& status = drive.status();
    if (drive.bus() == bus && status.doubled != canopen::Doubled::no) {
      view.doubled.push_back({.drive = drive.model().name,
                              .node = drive.model().node.node,
                              .proof = status.doubled == canopen::Doubled::proof,
                              .text = status.doubled_text});
    }
  }
  return alarms::bus_findings(view);
}

void Plant::Body::show(std::size_t bus) {
  alarms::AlarmRecord& alarm = lines[bus].alarm;
  if (!lines[bus].told || !show_findings(findings(bus), lines[bus].state, alarm)) {
    return;
  }
  if (alarm.fault_began()) {
    telling_bus = bus;
    first_out.on_fault({.bus = true, .index = bus}, canopen::Clock::now(), alarm.alarm().first);
    telling_bus.reset();
  }
  tell_bus_alarm(bus);
}

void Plant::Body::set_first(const alarms::FaultSource& source, bool first) {
  if (!source.bus) {
    drives[source.index].drive->set_first(source.kind, first);
  } else if (lines[source.index].alarm.set_first(first, canopen::wall_now()) && telling_bus != source.index) {
    tell_bus_alarm(source.index);
  }
}

void Plant::Body::tell_bus_alarm(std::size_t bus) const {
  for (Observer* observer : observers) {
    observer->on_bus_alarm(bus);
  }
}

}  // namespace process
