#include "config/load.h"

#include <algorithm>
#include <array>
#include <variant>

#include "config/check.h"
#include "config/drive_draft.h"
#include "config/files.h"
#include "config/load_site.h"
#include "config/reader.h"
#include "config/schema.h"

namespace config {
namespace {

// Fixed topics beside those of the drives.
constexpr std::array<std::string_view, 4> kReservedDrives{"bus", "status", "info", "result"};

struct Site {
  Model model;
  Node root;
  OnStale on_stale = OnStale::exception;
};

/// The bus a drive names, or the only one. Nothing, and a finding, where that does not tell.
std::optional<std::size_t> bus_of(const Node& table, const std::string& where, const Model& model, Report& report) {
  const auto name = read_text(table, "bus");
  if (!name.has_value()) {
    if (model.buses.size() > 1 && table.find("bus") == nullptr) {
      report.error(table.place, where + ": bus is missing; there are several");
    }
    return model.buses.size() == 1 ? std::optional<std::size_t>(0) : std::nullopt;
  }
  const auto found =
      std::find_if(model.buses.begin(), model.buses.end(), [&name](const Bus& bus) { return bus.name == *name; });
  if (found == model.buses.end()) {
    report.error(place_of(table, "bus"), where + ": bus \"" + *name + "\" is not among the buses");
    return std::nullopt;
  }
  return static_cast<std::size_t>(found - model.buses.begin());
}

Drive read_drive(const Node& table, std::size_t number, const Site& site, ProfileLibrary& library, Report& report) {
  const std::string name = read_text(table, "name").value_or("");
  DriveDraft draft{.site = table,
                   .report = report,
                   .where = "drive " + (name.empty() ? std::to_string(number) : "\"" + name + "\"")};
  const auto bus = bus_of(table, draft.where, site.model, report);
  if (bus.has_value()) {
    draft.bus = site.model.buses[*bus];
  }
  draft.drive.bus = bus.value_or(site.model.buses.size());
  draft.drive.on_stale = site.on_stale;
  read_own_keys(draft);
  if (std::find(kReservedDrives.begin(), kReservedDrives.end(), name) != kReservedDrives.end()) {
    draft.error(place_of(table, "name"), "the name is that of a fixed topic; choose another");
  }
  const Profile* const profile =
      draft.drive.profile.empty() ? nullptr
                                  : library.find(draft.drive.profile, place_of(table, "profile"), draft.where, report);
  if (profile == nullptr) {
    return draft.drive;
  }
  if (profile->partial) {
    draft.error(place_of(table, "profile"),
                "profile \"" + profile->name + "\" is only a part of others, not a drive by itself");
    return draft.drive;
  }
  compose(draft, *profile);
  read_node_settings(draft);
  read_pdos(draft);
  read_signals(draft);
  connect_pdos(draft);
  place_signals(draft);
  finish_signals(draft);
  advise(draft);
  return std::move(draft.drive);
}

std::string counted(std::size_t number, std::string_view one, std::string_view many) {
  return std::to_string(number) + " " + std::string(number == 1 ? one : many);
}

}  // namespace

Loaded load_text(std::string_view text, const LoadOptions& options, ProfileLibrary& library) {
  Report report;
  auto parsed = parse_toml(text, report.add_file(options.file.string()));
  if (const auto* failure = std::get_if<ParseFailure>(&parsed); failure != nullptr) {
    report.error(failure->place, failure->text);
    return {.model = std::nullopt, .findings = report.take()};
  }
  Site site{.model = {}, .root = std::get<Node>(std::move(parsed))};
  check(site.root, kSiteSection, "", report);
  site.model.gateway = read_gateway(site.root, options.host_name, report);
  site.model.buses = read_buses(site.root, report);
  site.model.modbus = read_modbus(site.root, report);
  site.model.mqtt = read_mqtt(site.root, options.file.parent_path(), report);
  if (const Node* const modbus = read_table(site.root, "modbus"); modbus != nullptr) {
    site.on_stale = read_on_stale(*modbus, site.on_stale);
    if (site.on_stale == OnStale::zero) {
      report.warning(place_of(*modbus, "on_stale"),
                     "modbus.on_stale = \"zero\" shows a lost drive as one that stands still");
    }
  }
  const auto drives = read_tables(site.root, "drive");
  for (const Node* const table : drives) {
    site.model.drives.push_back(read_drive(*table, site.model.drives.size() + 1, site, library, report));
  }
  check_drives(site.model, drives, report);
  const bool good = !report.has_errors();
  return {.model = good ? std::optional(std::move(site.model)) : std::nullopt, .findings = report.take()};
}

Loaded load_text(std::string_view text, const LoadOptions& options) {
  ProfileLibrary library(options.profile_dirs);
  return load_text(text, options, library);
}

Loaded load(const LoadOptions& options) {
  auto content = read_file(options.file);
  if (const auto* failure = std::get_if<FileFailure>(&content); failure != nullptr) {
    return {.model = std::nullopt,
            .findings = {{.file = options.file.string(), .text = "cannot be read: " + failure->reason}}};
  }
  return load_text(std::get<std::string>(content), options);
}

std::string summary(const Model& model) {
  std::size_t signals = 0;
  for (const Drive& drive : model.drives) {
    signals += drive.signals.size();
  }
  return "ok: " + counted(model.buses.size(), "bus", "buses") + ", " + counted(model.drives.size(), "drive", "drives") +
         ", " + counted(signals, "signal", "signals");
}

}  // namespace config
