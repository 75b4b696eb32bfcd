#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "config/model.h"

namespace gateway {

enum class MapFormat : std::uint8_t { table, json, csv, markdown };

/// `table`, `json`, `csv`, `markdown`.
[[nodiscard]] std::optional<MapFormat> parse_map_format(std::string_view name) noexcept;

/// Every signal of every drive with its object, its Modbus address and its topics; table and JSON also show the load of
/// each bus, forecast in percent. Where Modbus or MQTT is switched off
/// these are what it would use, and the table says so at its end.
[[nodiscard]] std::string render_map(const config::Model& model, MapFormat format);

/// The same as JSON: scripts rely on its keys and their order. A signal a line, numbers in plain decimal digits.
[[nodiscard]] std::string render_map_json(const config::Model& model);

}  // namespace gateway
