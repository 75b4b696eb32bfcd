#include "config/drive/builder.h"

#include <algorithm>
#include <array>

#include "config/schema/complaint.h"
#include "config/text.h"
#include "config/toml/document.h"

namespace config {
namespace {

using canopen::Duration;

// Fixed topics beside those of the drives.
constexpr std::array<std::string_view, 7> kReserved{"bus", "status", "info", "result", "health", "alarms", "stop"};

std::string quoted(Duration duration) {
  return in_quotes(to_text(duration));
}

/// `there are can0, can1`
std::string all_of(const std::vector<Bus>& buses) {
  std::string all;
  for (const Bus& bus : buses) {
    all += (all.empty() ? "there are " : ", ") + bus.name;
  }
  return all;
}

/// The bus a drive names, or the only one. Nothing, and a finding, where that does not tell.
std::optional<std::size_t> bus_of(const DriveDraft& draft) {
  const auto& buses = draft.model.buses;
  if (!draft.keys.bus.has_value()) {
    if (buses.size() > 1 && draft.site.find("bus") == nullptr) {
      draft.error(draft.site.place, "bus is missing; " + all_of(buses));
    }
    return buses.size() == 1 ? std::optional<std::size_t>(0) : std::nullopt;
  }
  const auto found =
      std::find_if(buses.begin(), buses.end(), [&draft](const Bus& bus) { return bus.name == *draft.keys.bus; });
  if (found == buses.end()) {
    // A bus without a name has its finding, and may be the one that is meant.
    if (std::none_of(buses.begin(), buses.end(), [](const Bus& bus) { return bus.name.empty(); })) {
      draft.error(place_of(draft.site, "bus"),
                  "bus \"" + *draft.keys.bus + "\" is not among the buses; " + all_of(buses));
    }
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - buses.begin());
}

/// Where only guarding is stated, there is no heartbeat: the two exclude each other.
void take_profiled_error_control(DriveDraft& draft) {
  canopen::ErrorControlSettings& control = draft.drive.node.error_control;
  control = draft.keys.error_control;
  if (control.guarding == Duration::zero()) {
    return;
  }
  if (draft.site.find("heartbeat") == nullptr) {
    control.heartbeat = Duration::zero();
  } else if (control.heartbeat != Duration::zero()) {
    draft.error(place_of(draft.site, "guarding"), "guarding " + quoted(control.guarding) + " and heartbeat " +
                                                      quoted(control.heartbeat) +
                                                      " exclude each other; leave one of them out");
  }
}

void check_timeout(DriveDraft& draft) {
  const canopen::ErrorControlSettings& control = draft.drive.node.error_control;
  const bool guarded = control.guarding != Duration::zero();
  const std::string period_name = guarded ? "guarding" : "heartbeat";
  const Duration period = guarded ? control.guarding : control.heartbeat;
  const std::string key = draft.site.find("heartbeat_timeout") != nullptr ? "heartbeat_timeout" : period_name;
  if (period == Duration::zero()) {
    return;
  }
  if (control.heartbeat_timeout <= period) {
    draft.error(place_of(draft.site, key), "heartbeat_timeout " + quoted(control.heartbeat_timeout) +
                                               " must be longer than " + period_name + " " + quoted(period) +
                                               "; three times it is usual");
  } else if (control.heartbeat_timeout < 2 * period) {
    draft.warning(place_of(draft.site, key), "heartbeat_timeout " + quoted(control.heartbeat_timeout) +
                                                 " is below twice the " + period_name + " " + quoted(period) +
                                                 ", so one late frame is a loss; three times it is usual");
  }
}

/// The drive trips without our requests.
void check_life_guarding(DriveDraft& draft) {
  constexpr int kLongestFactor = 255;  // 0x100D has 8 bits.
  const canopen::ErrorControlSettings& control = draft.drive.node.error_control;
  const Place place = place_of(draft.site, "supervise_gateway");
  const auto says = [&control](const std::string& relation) {
    return "supervise_gateway " + quoted(control.supervise_gateway) + " " + relation + " guarding " +
           quoted(control.guarding);
  };
  if (control.supervise_gateway <= control.guarding) {
    draft.error(place, says("must be longer than"));
  } else if (control.supervise_gateway > kLongestFactor * control.guarding) {
    draft.error(place, says("is more than 255 times") + ", which a drive cannot count; set a longer guarding");
  } else if (control.supervise_gateway < 2 * control.guarding) {
    draft.warning(place, says("is below twice") + ", so one late request trips the drive; three times it is usual");
  }
}

/// It trips without our heartbeat.
void check_consumer(DriveDraft& draft) {
  const Duration limit = draft.drive.node.error_control.supervise_gateway;
  const Place place = place_of(draft.site, "supervise_gateway");
  const std::string bus = "bus \"" + draft.bus.name + "\"";
  if (draft.bus.node_id == 0) {
    draft.error(place, "supervise_gateway needs a gateway with a node id; set node_id of " + bus);
  } else if (draft.bus.heartbeat == Duration::zero()) {
    draft.error(place, "supervise_gateway needs the gateway's heartbeat; set heartbeat of " + bus);
  } else if (limit <= draft.bus.heartbeat) {
    draft.error(place, "supervise_gateway " + quoted(limit) + " must be longer than the heartbeat " +
                           quoted(draft.bus.heartbeat) + " of " + bus);
  } else if (limit < 2 * draft.bus.heartbeat) {
    draft.warning(place, "supervise_gateway " + quoted(limit) + " is below twice the heartbeat " +
                             quoted(draft.bus.heartbeat) + " of " + bus +
                             ", so one late frame trips the drive; three times it is usual");
  }
}

void check_supervision(DriveDraft& draft) {
  const canopen::ErrorControlSettings& control = draft.drive.node.error_control;
  if (control.supervise_gateway == Duration::zero()) {
    return;
  }
  if (control.guarding != Duration::zero()) {
    check_life_guarding(draft);
  } else if (draft.drive.bus < draft.model.buses.size()) {
    check_consumer(draft);
  }
}

/// The profile that the drive names; null, and a finding, where there is none.
const Profile* profile_of(const DriveDraft& draft, ProfileLibrary& library) {
  if (draft.keys.profile.empty()) {
    return nullptr;
  }
  const Place place = place_of(draft.site, "profile");
  const Profile* const profile = library.find(draft.keys.profile, place, draft.where, draft.report);
  if (profile != nullptr && profile->partial) {
    draft.error(place, "profile \"" + profile->name + "\" is only a part of others, not a drive by itself");
    return nullptr;
  }
  return profile;
}

}  // namespace

void take_own_keys(DriveDraft& draft) {
  Drive& drive = draft.drive;
  const DriveKeys& keys = draft.keys;
  drive.name = keys.name;
  drive.enabled = keys.enabled;
  drive.profile = keys.profile;
  // An id out of range has its finding; 0 keeps it out of what is worked out from it.
  drive.node.node = keys.node;
  drive.node.gateway_node = draft.bus.node_id;
  drive.node.gateway_heartbeat = draft.bus.node_id == 0 ? Duration::zero() : draft.bus.heartbeat;
  drive.node.reconfigure_running = keys.reconfigure_running;
  drive.node.restart = keys.restart;
  drive.on_stale = keys.on_stale.value_or(draft.model.modbus.has_value() ? draft.model.modbus->on_stale : OnStale());
  drive.unit = keys.unit.value_or(Unit{keys.node}).number;
  drive.flat = keys.flat;
  drive.commands = keys.commands;
  if (std::find(kReserved.begin(), kReserved.end(), keys.name) != kReserved.end()) {
    draft.error(place_of(draft.site, "name"), "the name is that of a fixed topic; choose another");
  }
  take_profiled_error_control(draft);
  check_timeout(draft);
  check_supervision(draft);
}

BuiltDrive build_drive(const Node& site, std::size_t number, const Model& model, ProfileLibrary& library,
                       Report& report) {
  DriveDraft draft{.site = site, .model = model, .report = report, .where = {}, .keys = drive_section().read(site)};
  const auto name = read_text(site, "name");
  draft.where = "drive " + (name.has_value() ? in_quotes(*name) : std::to_string(number));
  const auto bus = bus_of(draft);
  draft.bus = bus.has_value() ? model.buses[*bus] : Bus{};
  draft.drive.bus = bus.value_or(model.buses.size());
  take_own_keys(draft);
  const Profile* const profile = profile_of(draft, library);
  if (profile == nullptr) {
    return {.drive = std::move(draft.drive), .notes = {}};
  }
  compose(draft, *profile);
  draft.said = overlay_section().read(draft.merged);
  take_node_settings(draft);
  take_notes(draft);
  take_pdos(draft);
  take_signals(draft);
  connect_pdos(draft);
  place_signals(draft);
  order_signals(draft);
  take_commands(draft);
  draft.notes.supervised_rpdo = supervised_rpdo(draft);
  advise(draft);
  return {.drive = std::move(draft.drive), .notes = std::move(draft.notes)};
}

}  // namespace config
