#include "config/load.h"

#include <variant>

#include "config/drive/builder.h"
#include "config/drive/profile.h"
#include "config/site/site.h"
#include "config/site/site_keys.h"
#include "config/toml/document.h"
#include "config/toml/files.h"

namespace config {
namespace {

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
  const Node root = std::get<Node>(std::move(parsed));
  check_table(root, site_section(), Complaint("", report));
  Model model;
  model.gateway = read_gateway(root, options.host_name, report);
  model.buses = read_buses(root, report);
  model.modbus = read_modbus(root, report);
  model.mqtt = read_mqtt(root, options.file.parent_path(), options.with_secrets, report);
  model.http = read_http(root, model.modbus, report);
  model.recorder = read_recorder(root, model.gateway, model.buses, report);
  std::vector<DriveNotes> notes;
  for (const Node* const table : read_tables(root, "drive")) {
    BuiltDrive built = build_drive(*table, model.drives.size() + 1, model, library, report);
    model.drives.push_back(std::move(built.drive));
    notes.push_back(std::move(built.notes));
  }
  check_drives(model, root, report);
  if (report.has_errors()) {
    return {.model = std::nullopt, .findings = report.take()};
  }
  advise_on_load(model, root, report);
  return {.model = std::move(model), .findings = report.take(), .notes = std::move(notes)};
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
