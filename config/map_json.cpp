#include "config/map_json.h"

#include <array>
#include <cstdio>
#include <string_view>

#include "config/map.h"
#include "config/text.h"

namespace config {
namespace {

std::string json_text(std::string_view text) {
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

std::string json_text_or_null(const std::optional<std::string>& text) {
  return text.has_value() ? json_text(*text) : "null";
}

std::string json_number(const std::optional<double>& number) {
  return number.has_value() ? to_text(*number) : "null";
}

std::string values_of(const Signal& signal) {
  if (signal.values.empty()) {
    return "null";
  }
  std::string out;
  for (const auto& [number, name] : signal.values) {
    out += (out.empty() ? "{" : ", ") + json_text(std::to_string(number)) + ": " + json_text(name);
  }
  return out + "}";
}

std::string json_modbus(const Drive& drive, const ModbusPlace& place) {
  if (!drive.unit.has_value() || place.kind == ModbusKind::none) {
    return "null";
  }
  return std::string("{\"kind\": ") + (place.kind == ModbusKind::bit ? "\"bit\"" : "\"register\"") +
         ", \"address\": " + std::to_string(place.address) + ", \"count\": " + std::to_string(place.count) + "}";
}

std::string signal_of(const Model& model, const Drive& drive, const Signal& signal) {
  return "{\"name\": " + json_text(signal.name) + ", \"object\": " + json_text(canopen::to_string(signal.object)) +
         ", \"type\": " + json_text(canopen::name_of(signal.type)) + ", \"scale\": " + to_text(signal.scale) +
         ", \"unit\": " + json_text(signal.unit) + ", \"access\": " + json_text(name_of(signal.access)) +
         ", \"source\": " + json_text(to_string(signal.source)) + ", \"min\": " + json_number(signal.min) +
         ", \"max\": " + json_number(signal.max) + ", \"values\": " + values_of(signal) +
         ", \"modbus\": " + json_modbus(drive, signal.modbus) +
         ", \"mqtt\": {\"topic\": " + json_text_or_null(value_topic(model, drive, signal)) +
         ", \"set\": " + json_text_or_null(set_topic(model, drive, signal)) + "}}";
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
  std::string out = "{\"gateway\": " + json_text(model.gateway.name) + ", \"base\": " + json_text(base_topic(model)) +
                    ",\n \"drives\": [";
  bool first_drive = true;
  for (const Drive& drive : model.drives) {
    const std::string bus = drive.bus < model.buses.size() ? model.buses[drive.bus].name : "";
    out += first_drive ? "" : ",\n  ";
    first_drive = false;
    out += "{\"name\": " + json_text(drive.name) + ", \"bus\": " + json_text(bus) +
           ", \"node\": " + std::to_string(drive.node.node) + ", \"profile\": " + json_text(drive.profile) +
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
