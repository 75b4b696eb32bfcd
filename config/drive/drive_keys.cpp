#include "config/drive/drive_keys.h"

#include <chrono>

#include "config/address_map.h"
#include "config/site/site_keys.h"

namespace config {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

std::optional<Writers> read_writers(const Node& node, const Complaint& complain) {
  using Way = bool Writers::*;
  static const Form<Way> way_form =
      choice<Way>({{"modbus", &Writers::modbus}, {"mqtt", &Writers::mqtt}, {"local", &Writers::local}});
  if (!expect_list(node, complain)) {
    return std::nullopt;
  }
  Writers writers;
  bool good = true;
  for (const Node& item : node.items) {
    if (const auto way = way_form.read(item, complain); way.has_value()) {
      writers.** way = true;
    } else {
      good = false;
    }
  }
  return good ? std::optional(writers) : std::nullopt;
}

/// Which signals there are, and what they may be, shows only once the drive is put together.
void check_timeout_values(const Node& node, const Complaint& complain) {
  if (!expect(node, NodeKind::table, complain, "{ control_command = 5 }")) {
    return;
  }
  for (const Entry& entry : node.entries) {
    const NodeKind kind = entry.value.kind;
    if (kind != NodeKind::integer && kind != NodeKind::number && kind != NodeKind::text && kind != NodeKind::boolean) {
      complain.at(entry.key).value(entry.value.place, "must be a number or a name, not " + std::string(name_of(kind)));
    }
  }
}

Form<Writers> writers() {
  return {.type = "list of `modbus`, `mqtt`, `local`", .read = read_writers, .show = [](const Writers&) {
            return std::string("[]");
          }};
}

const SectionOf<Commands>& commands_section() {
  using Field = KeyOf<Commands>;
  static const SectionOf<Commands> section(
      "[drive.commands]",
      {Field("writers", &Commands::writers, writers(),
             "Who may command: `modbus`, `mqtt`, `local` (the command line, by `gateway.control`). Nobody else may "
             "write, "
             "send NMT commands or write raw objects.")
           .note("nobody"),
       Field("raw", &Commands::raw, boolean(), "`true`: writers may write objects that are no writable signal."),
       Field("nmt_while_running", &Commands::nmt_while_running, boolean(),
             "`true`: NMT stop, pre-operational and resets also while the motor runs."),
       Field("deadline", &Commands::deadline, duration({.min = milliseconds(10), .max = minutes(1)}),
             "Of one command, answer included."),
       Field("lease", &Commands::lease, duration({.min = seconds(0), .max = hours(24)}),
             "A writer keeps the drive to itself until silent for this long; `0s`: nobody does."),
       Field("feedback", &Commands::feedback, duration({.min = seconds(0), .max = hours(1)}),
             "How long after a run command `running` may still be false before an alarm is raised; `0s`: for ever."),
       Field("timeout", &Commands::timeout, duration({.min = seconds(0), .max = hours(24)}),
             "Silence of the writer of the last run command after which `on_timeout` acts; `0s`: never."),
       Field("on_timeout", &Commands::on_timeout,
             choice<OnTimeout>({{"hold", OnTimeout::hold}, {"cease", OnTimeout::cease}, {"values", OnTimeout::values}}),
             "What a timeout does beside its alarm: nothing; no RPDO is sent any more, and the drive, which supervises "
             "one, trips; `values` are written."),
       Field::checked("values", "table: signal = value", Layering::replace, nullptr, check_timeout_values,
                      "What `on_timeout = \"values\"` writes, in engineering units or by name: a stop for "
                      "`control_command`, or set-points only.")});
  return section;
}

KeyOf<DriveKeys> slots_key(std::string_view name, std::string_view meaning) {
  return KeyOf<DriveKeys>::checked(name, numbered_texts(1, kLastSlot), meaning).unset("the profile's");
}

}  // namespace

const SectionOf<DriveKeys>& drive_section() {
  using Field = KeyOf<DriveKeys>;
  using canopen::ErrorControlSettings;
  const auto time = [](auto member) { return [member](auto& said) -> auto& { return said.error_control.*member; }; };
  static const SectionOf<DriveKeys> section(
      "[[drive]]",
      {Field("name", &DriveKeys::name, name(), "Names the drive in topics and findings.").required(),
       Field("bus", &DriveKeys::bus, text(), "Name of its bus; needed where there are several.").unset("the only bus"),
       Field("node", &DriveKeys::node, integer(1, 127), "Node id.").required(),
       Field("profile", &DriveKeys::profile, name(), "What kind of drive it is.").required("eds"),
       Field::later("eds", "string", "", "A drive from an EDS file."),
       Field("enabled", &DriveKeys::enabled, boolean(),
             "`false`: out of service; no traffic, no alarms, offline. Its unit and its addresses stay."),
       Field("unit", &DriveKeys::unit, unit(), "Modbus unit; `\"none\"`: not on Modbus.").unset("the node id"),
       Field(
           "flat", &DriveKeys::flat, integer(0, kAddresses - kFlatBlock),
           "Its base address on `modbus.flat_unit`: 0..899 of its own unit stand there, its diagnostics at base + 900.")
           .unset("none"),
       Field("heartbeat", time(&ErrorControlSettings::heartbeat),
             duration({.min = seconds(0), .max = kLongest16, .whole_ms = true}),
             "Heartbeat period written to the drive (0x1017), whole milliseconds; `0s`, or `guarding` alone: none."),
       Field("heartbeat_timeout", time(&ErrorControlSettings::heartbeat_timeout),
             duration({.min = milliseconds(2), .max = minutes(10)}),
             "Silence that means the drive is lost; longer than `heartbeat` or `guarding`. Without either: no TPDO and "
             "no "
             "SDO answer for so long; it is read that often."),
       Field("guarding", time(&ErrorControlSettings::guarding),
             duration({.min = seconds(0), .max = kLongest16, .whole_ms = true}),
             "Period of node guarding, whole milliseconds, for drives without heartbeat; `0s`: none."),
       Field("supervise_gateway", time(&ErrorControlSettings::supervise_gateway),
             duration({.min = seconds(0), .max = kLongest16, .whole_ms = true}),
             "The drive notices when the gateway's heartbeat is missing this long (0x1016), or its guarding requests "
             "(0x100C, 0x100D), and trips, or does what is set in it; `0s`: it does not."),
       Field("restart", &DriveKeys::restart, boolean(),
             "`true`: a drive that left operational by itself is configured and started again after 5 s, then 10 s, up "
             "to 60 s; not where its motor runs or its `control_command` is no `stop`, as read by SDO."),
       Field("on_stale", &DriveKeys::on_stale, on_stale_form(), "The same for this drive alone.")
           .unset("as in [modbus]"),
       Field("reconfigure_running", &DriveKeys::reconfigure_running, boolean(),
             "`true`: a drive found operational with other settings is configured all the same."),
       Field("presets", &DriveKeys::presets, list("list of strings", text()), "Parts of the profile to switch on."),
       slots_key("settings",
                 "What the freely assigned set-points of the drive mean: `{ 1 = \"frequency_command\" }`; `\"unused\"` "
                 "sends 0."),
       slots_key("returns", "What the freely assigned returned values of the drive mean."),
       table_key<DriveKeys>("commands", &DriveKeys::commands, commands_section(), "Who may command it.")},
      &overlay_section());
  return section;
}

}  // namespace config
