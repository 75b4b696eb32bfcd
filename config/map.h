#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "config/model.h"

namespace config {

enum class MapFormat : std::uint8_t { table, json, csv, markdown };

/// `table`, `json`, `csv`, `markdown`.
[[nodiscard]] std::optional<MapFormat> parse_map_format(std::string_view name) noexcept;

/// Every signal of every drive with its object, its Modbus address and its topics. Topics are those that MQTT would
/// use where it is switched off.
[[nodiscard]] std::string render_map(const Model& model, MapFormat format);

/// `canopen/line3`: the topic in front of everything that this gateway publishes.
[[nodiscard]] std::string base_topic(const Model& model);

/// `tpdo1`, `rpdo1`, `sdo`.
[[nodiscard]] std::string to_string(const Source& source);
/// `read`, `write`, `read-write`.
[[nodiscard]] std::string_view name_of(Access access) noexcept;

}  // namespace config
