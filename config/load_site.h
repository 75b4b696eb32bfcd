#pragma once

#include <string>
#include <string_view>

#include "config/load.h"
#include "config/model.h"
#include "config/profile.h"
#include "config/report.h"

// The parts of a site's file, each read out of its checked table.

namespace config {

/// Reads a whole file's text with the profiles of `library`; see load().
[[nodiscard]] Loaded load_text(std::string_view text, const LoadOptions& options, ProfileLibrary& library);

[[nodiscard]] Gateway read_gateway(const Node& root, const std::string& host_name, Report& report);
[[nodiscard]] std::vector<Bus> read_buses(const Node& root, Report& report);
[[nodiscard]] std::optional<Modbus> read_modbus(const Node& root, Report& report);
/// `directory` is where a relative password_file is looked for.
[[nodiscard]] std::optional<Mqtt> read_mqtt(const Node& root, const std::filesystem::path& directory, Report& report);
/// `modbus.on_stale`, which drives inherit.
[[nodiscard]] OnStale read_on_stale(const Node& table, OnStale standard);
/// What must differ from drive to drive: names, node ids, Modbus units, COB-IDs. `tables` holds each drive's own.
void check_drives(const Model& model, const std::vector<const Node*>& tables, Report& report);

}  // namespace config
