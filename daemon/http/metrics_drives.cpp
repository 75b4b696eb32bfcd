#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include "canopen/hex.h"
#include "daemon/http/metrics.h"

namespace gateway::http {
namespace {

using canopen::AbortCounts;
using canopen::NodeStatus;
using canopen::TimePoint;

double seconds_between(TimePoint since, TimePoint now) {
  return std::chrono::duration<double>(now - since).count();
}

std::string boot_word(canopen::BootResult result) {
  if (canopen::is_letter(result)) {
    return {static_cast<char>(result)};
  }
  return result == canopen::BootResult::ok ? "ok" : "not-booted";
}

// Of what the drive has and has sent.
std::optional<TimePoint> oldest_source(const process::Image& image) {
  std::optional<TimePoint> oldest;
  for (const process::SourceState& source : image.sources()) {
    if (!source.absent && source.received) {
      oldest = oldest ? std::min(*oldest, source.at) : source.at;
    }
  }
  return oldest;
}

struct DriveFamilies {
  Family info = Families::gauge("drive_info", "1; the labels tell what the drive is.");
  Family enabled = Families::gauge("drive_enabled", "0: the drive is out of service.");
  Family online = Families::gauge("drive_online", "1: alive and booted, and its bus is up.");
  Family operational = Families::gauge("drive_operational", "1: NMT state operational.");
  Family boot = Families::gauge("drive_boot_result",
                                "1; the label result tells how the newest boot went: ok, "
                                "not-booted, or the error letter of CiA 302-2.");
  Family boot_ups = Families::counter("drive_boot_ups_total", "Boot-up messages seen.");
  Family emergencies = Families::counter("drive_emergencies_total", "Emergency messages seen.");
  Family losses = Families::counter("drive_heartbeat_losses_total", "How often the drive fell silent.");
  Family heartbeat = Families::gauge("drive_heartbeat_age_seconds",
                                     "Since the newest heartbeat or guarding answer; missing before the first.");
  Family fresh = Families::gauge("drive_values_fresh", "1: all values are fresh.");
  Family oldest =
      Families::gauge("drive_oldest_value_age_seconds", "Age of the oldest process value; missing before the first.");
  Family aborts = Families::counter("drive_sdo_aborts_total", "SDO transfers that the drive refused, by abort code.");

  void add(const process::Plant& plant, const process::Drive& drive, TimePoint now);
};

void DriveFamilies::add(const process::Plant& plant, const process::Drive& drive, TimePoint now) {
  const config::Drive& model = drive.model();
  const NodeStatus& status = drive.status();
  const Labels labels{{"drive", model.name}};
  info.add({{"drive", model.name},
            {"bus", plant.model().buses[drive.bus()].name},
            {"node", std::to_string(model.node.node)},
            {"profile", model.profile}},
           true);
  enabled.add(labels, model.enabled);
  online.add(labels, status.online);
  operational.add(labels, status.nmt_now() == canopen::NmtState::operational);
  boot.add({{"drive", model.name}, {"result", boot_word(status.boot_result)}}, true);
  boot_ups.add(labels, std::uint64_t{status.boot_ups});
  emergencies.add(labels, std::uint64_t{status.emergencies});
  losses.add(labels, std::uint64_t{status.heartbeat_losses});
  if (status.last_heartbeat) {
    heartbeat.add(labels, seconds_between(*status.last_heartbeat, now));
  }
  fresh.add(labels, drive.image().all_fresh(now));
  if (const auto at = oldest_source(drive.image())) {
    oldest.add(labels, seconds_between(*at, now));
  }
  for (const auto& [code, count] : drive.sdo_aborts().by_code()) {
    const std::string word = code == AbortCounts::kOther ? "other" : "0x" + canopen::hex(code, 8);
    aborts.add({{"drive", model.name}, {"code", word}}, count);
  }
}

constexpr std::array kSeverities{config::Severity::fault, config::Severity::warning};

}  // namespace

void add_drive(Families& families, const process::Plant& plant, const process::Drive& drive, TimePoint now) {
  DriveFamilies told;
  told.add(plant, drive, now);
  for (Family* const family :
       {&told.info, &told.enabled, &told.online, &told.operational, &told.boot, &told.boot_ups, &told.emergencies,
        &told.losses, &told.heartbeat, &told.fresh, &told.oldest, &told.aborts}) {
    families.take(std::move(*family));
  }
}

void add_alarms(Families& families, const process::Drive& drive) {
  Family told = Families::gauge("drive_alarm_active",
                                "1: this alarm of the drive is active; missing while that is "
                                "not known.");
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    if (const alarms::Alarm& alarm = drive.alarm(kind); alarm.known) {
      told.add({{"drive", drive.model().name}, {"kind", std::string(name_of(kind))}}, alarm.active);
    }
  }
  families.take(std::move(told));
}

void add_alarm_counts(Families& families, const process::Plant& plant) {
  std::map<std::pair<std::string, config::Severity>, std::uint64_t> active;
  for (const config::Severity severity : kSeverities) {
    active[{"bus", severity}] = 0;
    for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
      active[{std::string(name_of(kind)), severity}] = 0;
    }
  }
  Family of_buses = Families::gauge("bus_alarm_active", "1: the alarm of the bus is active.");
  for (std::size_t i = 0; i < plant.model().buses.size(); ++i) {
    of_buses.add({{"bus", plant.model().buses[i].name}}, plant.bus_alarm(i).known && plant.bus_alarm(i).active);
  }
  for (const process::ActiveAlarm& one : plant.active_alarms()) {
    ++active[{one.drive == nullptr ? "bus" : std::string(name_of(one.kind)), one.alarm->severity}];
  }
  Family counts = Families::gauge("alarms_active", "Active alarms, by kind and severity.");
  for (const auto& [key, count] : active) {
    counts.add({{"kind", key.first}, {"severity", std::string(alarms::name_of(key.second))}}, count);
  }
  families.take(std::move(counts));
  families.take(std::move(of_buses));
}

}  // namespace gateway::http
