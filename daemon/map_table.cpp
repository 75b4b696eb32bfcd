#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <vector>

#include "config/bus_load.h"
#include "config/text.h"
#include "daemon/map.h"
#include "daemon/map_text.h"

namespace gateway {
namespace {

constexpr std::size_t kColumns = 14;
using Row = std::array<std::string, kColumns>;

constexpr std::array<std::string_view, kColumns> kHeadings{"drive",  "signal", "object", "type", "scale",
                                                           "unit",   "access", "source", "min",  "max",
                                                           "modbus", "topic",  "set",    "note"};

std::string number_of(const std::optional<double>& number) {
  return number.has_value() ? config::to_text(*number) : "";
}

/// `5: register 2`, `5: register 200-201`, `5: bit 0`.
std::string place_text(std::uint8_t unit, const config::ModbusPlace& place) {
  std::string text = std::to_string(unit) + (place.kind == config::ModbusKind::bit ? ": bit " : ": register ") +
                     std::to_string(place.address);
  if (place.count > 1) {
    text.append("-").append(std::to_string(place.address + place.count - 1));
  }
  return text;
}

/// On its own unit and on the flat one: `5: register 2; 1: register 3002`.
std::string modbus_of(const config::Model& model, const config::Drive& drive, const config::Signal& signal) {
  std::string text;
  std::optional<config::ModbusPlace> place = modbus_place(drive, signal);
  if (place && drive.unit) {
    text = place_text(*drive.unit, *place);
  }
  if (const std::optional<std::uint16_t> flat = flat_address(model, drive, signal); place && flat) {
    place->address = *flat;
    text += (text.empty() ? "" : "; ") + place_text(*model.modbus->flat_unit, *place);
  }
  return text;
}

std::vector<Row> rows_of(const config::Model& model) {
  std::vector<Row> rows;
  for (const config::Drive& drive : model.drives) {
    for (const config::Signal& signal : drive.signals) {
      rows.push_back({drive.name, signal.name, canopen::to_string(signal.object),
                      std::string(canopen::name_of(signal.type)), config::to_text(signal.scale), signal.unit,
                      std::string(to_text(signal.access)), to_text(signal.source), number_of(signal.min),
                      number_of(signal.max), modbus_of(model, drive, signal),
                      value_topic(model, drive, signal).value_or(""), set_topic(model, drive, signal).value_or(""),
                      signal.unconfirmed ? "unconfirmed" : ""});
    }
  }
  return rows;
}

/// Characters, not bytes, so that "°C" keeps its column.
std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string percent_text(double share, bool at_least) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%s%.1f %%", at_least ? "at least " : "", percent(share));
  return text.data();
}

/// `bus can0  250000 bit/s  load 27.3 %  worst 33.5 %`
std::string bus_lines(const config::Model& model) {
  std::string out;
  for (std::size_t i = 0; i < model.buses.size(); ++i) {
    const config::Bus& bus = model.buses[i];
    out += "bus " + bus.name + "  ";
    out += bus.bitrate ? std::to_string(*bus.bitrate) + " bit/s" : "no bitrate stated";
    if (const std::optional<config::BusLoad> load = config::forecast_load(model, i)) {
      out += "  load " + percent_text(load->usual, load->at_least);
      out += "  worst " + percent_text(load->worst, load->at_least);
    }
    out += "\n";
  }
  return out;
}

// Without these lines the addresses look served.
std::string what_is_off(const config::Model& model) {
  std::string out;
  if (!model.modbus) {
    out += "Modbus is off: there is no [modbus] in the configuration; these would be the registers and bits.\n";
  }
  if (!model.mqtt) {
    out += "MQTT is off: there is no [mqtt] in the configuration; these would be the topics.\n";
  }
  return out;
}

std::string render_table(const config::Model& model) {
  const auto rows = rows_of(model);
  std::array<std::size_t, kColumns> widths{};
  for (std::size_t i = 0; i < kColumns; ++i) {
    widths.at(i) = width_of(kHeadings.at(i));
    for (const Row& row : rows) {
      widths.at(i) = std::max(widths.at(i), width_of(row.at(i)));
    }
  }
  std::string out;
  const auto line = [&](const auto& cells) {
    std::string text;
    for (std::size_t i = 0; i < kColumns; ++i) {
      text += std::string(cells.at(i)) + std::string(widths.at(i) - width_of(cells.at(i)) + 2, ' ');
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out += text + "\n";
  };
  line(kHeadings);
  for (const Row& row : rows) {
    line(row);
  }
  return out + bus_lines(model) + what_is_off(model);
}

std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == std::string_view::npos) {
    return std::string(text);
  }
  std::string cell = "\"";
  for (const char c : text) {
    cell += c == '"' ? "\"\"" : std::string(1, c);
  }
  return cell + "\"";
}

std::string markdown_cell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    cell += c == '|' ? "\\|" : std::string(1, c);
  }
  return cell;
}

std::string render_csv(const config::Model& model) {
  std::string out;
  const auto line = [&out](const auto& cells) {
    for (std::size_t i = 0; i < kColumns; ++i) {
      out += (i == 0 ? "" : ",") + csv_cell(cells.at(i));
    }
    out += "\n";
  };
  line(kHeadings);
  for (const Row& row : rows_of(model)) {
    line(row);
  }
  return out;
}

std::string render_markdown(const config::Model& model) {
  std::string out;
  const auto line = [&out](const auto& cells) {
    for (const auto& cell : cells) {
      out.append("| ").append(markdown_cell(cell)).append(" ");
    }
    out += "|\n";
  };
  line(kHeadings);
  for (std::size_t i = 0; i < kColumns; ++i) {
    out += "|---";
  }
  out += "|\n";
  for (const Row& row : rows_of(model)) {
    line(row);
  }
  return out;
}

}  // namespace

std::optional<MapFormat> parse_map_format(std::string_view name) noexcept {
  if (name == "table") {
    return MapFormat::table;
  }
  if (name == "json") {
    return MapFormat::json;
  }
  if (name == "csv") {
    return MapFormat::csv;
  }
  return name == "markdown" ? std::optional(MapFormat::markdown) : std::nullopt;
}

std::string render_map(const config::Model& model, MapFormat format) {
  switch (format) {
    case MapFormat::json:
      return render_map_json(model);
    case MapFormat::csv:
      return render_csv(model);
    case MapFormat::markdown:
      return render_markdown(model);
    case MapFormat::table:
      break;
  }
  return render_table(model);
}

}  // namespace gateway
