#include "config/map_json.h"

#include <array>
#include <cstdio>
#include <string_view>

#include "config/map.h"
#include "config/text.h"

namespace config {
namespace {

std::string quoted(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      std::array<char, 8> escape{};
      std::snprintf(escape.data(), escape.size(), "\\u%04x", static_cast<unsigned>(static_cast<unsigned char>(c)));
      out += escape.data();
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string quoted_or_null(const std::optional<std::string>& text) {
  return text.has_value() ? quoted(*text) : "null";
}

std::string number_of(const std::optional<double>& number) {
  return number.has_value() ? to_text(*number) : "null";
}

std::string values_of(const Signal& signal) {
  if (signal.values.empty()) {
    return "null";
  }
  std::string out;
  for (const auto& [number, name] : signal.values) {
    out += (out.empty() ? "{" : ", ") + quoted(std::to_string(number)) + ": " + quoted(name);
  }
  return out + "}";
}

std::string modbus_of(const Drive& drive, const ModbusPlace& place) {
  if (!drive.unit.has_value() || place.kind == ModbusKind::none) {
    return "null";
  }
  return std::string("{\"kind\": ") + (place.kind == ModbusKind::bit ? "\"bit\"" : "\"register\"") +
         ", \"address\": " + std::to_string(place.address) + ", \"count\": " + std::to_string(place.count) + "}";
}

std::string signal_of(const Model& model, const Drive& drive, const Signal& signal) {
  return "{\"name\": " + quoted(signal.name) + ", \"object\": " + quoted(canopen::to_string(signal.object)) +
         ", \"type\": " + quoted(canopen::name_of(signal.type)) + ", \"scale\": " + to_text(signal.scale) +
         ", \"unit\": " + quoted(signal.unit) + ", \"access\": " + quoted(name_of(signal.access)) +
         ", \"source\": " + quoted(to_string(signal.source)) + ", \"min\": " + number_of(signal.min) +
         ", \"max\": " + number_of(signal.max) + ", \"values\": " + values_of(signal) +
         ", \"modbus\": " + modbus_of(drive, signal.modbus) +
         ", \"mqtt\": {\"topic\": " + quoted_or_null(value_topic(model, drive, signal)) +
         ", \"set\": " + quoted_or_null(set_topic(model, drive, signal)) + "}}";
}

std::string topic_of(const Model& model, const Drive& drive, const Signal& signal) {
  return base_topic(model) + "/" + drive.name + "/" + signal.name;
}

}  // namespace

std::optional<std::string> value_topic(const Model& model, const Drive& drive, const Signal& signal) {
  const bool published = !model.mqtt.has_value() || model.mqtt->signals;
  return readable(signal.access) && published ? std::optional(topic_of(model, drive, signal)) : std::nullopt;
}

std::optional<std::string> set_topic(const Model& model, const Drive& drive, const Signal& signal) {
  return writable(signal.access) ? std::optional(topic_of(model, drive, signal) + "/set") : std::nullopt;
}

std::string render_map_json(const Model& model) {
  std::string out =
      "{\"gateway\": " + quoted(model.gateway.name) + ", \"base\": " + quoted(base_topic(model)) + ",\n \"drives\": [";
  bool first_drive = true;
  for (const Drive& drive : model.drives) {
    const std::string bus = drive.bus < model.buses.size() ? model.buses[drive.bus].name : "";
    out += first_drive ? "" : ",\n  ";
    first_drive = false;
    out += "{\"name\": " + quoted(drive.name) + ", \"bus\": " + quoted(bus) +
           ", \"node\": " + std::to_string(drive.node.node) + ", \"profile\": " + quoted(drive.profile) +
           ", \"modbus_unit\": " + (drive.unit.has_value() ? std::to_string(*drive.unit) : "null") +
           ",\n   \"signals\": [";
    bool first_signal = true;
    for (const Signal& signal : drive.signals) {
      out += first_signal ? "" : ",\n     ";
      first_signal = false;
      out += signal_of(model, drive, signal);
    }
    out += "]}";
  }
  return out + "]}\n";
}

}  // namespace config
