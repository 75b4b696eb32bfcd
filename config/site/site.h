#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "config/model.h"
#include "config/toml/document.h"
#include "config/toml/report.h"

// The parts of a site's file beside its drives, each read out of its checked table, and what must fit between them.

namespace config {

[[nodiscard]] Gateway read_gateway(const Node& root, const std::string& host_name, Report& report);
[[nodiscard]] std::vector<Bus> read_buses(const Node& root, Report& report);
[[nodiscard]] std::optional<Modbus> read_modbus(const Node& root, Report& report);
/// `directory` is where relative files are looked for that are no credentials of systemd's; the password is read, to
/// see whether there is one, only `with_secrets`.
[[nodiscard]] std::optional<Mqtt> read_mqtt(const Node& root, const std::filesystem::path& directory, bool with_secrets,
                                            Report& report);
/// `modbus`: what listens already.
[[nodiscard]] std::optional<Http> read_http(const Node& root, const std::optional<Modbus>& modbus, Report& report);
/// `gateway`: where records would lie; `buses`: how long they may be.
[[nodiscard]] std::optional<Recorder> read_recorder(const Node& root, const Gateway& gateway,
                                                    const std::vector<Bus>& buses, Report& report);
/// What must differ from drive to drive: names, node ids, Modbus units and places on the flat one, COB-IDs.
void check_drives(const Model& model, const Node& root, Report& report);
/// Warns of buses that are forecast to be too busy.
void advise_on_load(const Model& model, const Node& root, Report& report);

}  // namespace config
