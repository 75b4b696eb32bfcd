#include <boost/json/array.hpp>
#include <boost/json/object.hpp>
#include <boost/json/serialize.hpp>
#include <boost/json/value.hpp>
#include <utility>

#include "config/bus_load.h"
#include "config/text.h"
#include "daemon/map.h"
#include "daemon/map_text.h"

namespace gateway {
namespace {

namespace json = boost::json;

template <class T>
json::value value_or_null(const std::optional<T>& value) {
  return value.has_value() ? json::value(*value) : json::value(nullptr);
}

json::object json_bus(const config::Model& model, std::size_t bus) {
  const std::optional<config::BusLoad> load = config::forecast_load(model, bus);
  json::object object;
  object["name"] = model.buses[bus].name;
  object["bitrate"] = value_or_null(model.buses[bus].bitrate);
  object["load"] = load ? json::value(percent(load->usual)) : json::value(nullptr);
  object["load_worst"] = load ? json::value(percent(load->worst)) : json::value(nullptr);
  object["at_least"] = load && load->at_least;
  return object;
}

json::value json_values(const config::Signal& signal) {
  if (signal.values.empty()) {
    return nullptr;
  }
  json::object names;
  for (const auto& [number, name] : signal.values) {
    names[std::to_string(number)] = name;
  }
  return names;
}

json::value json_modbus(const config::Model& model, const config::Drive& drive, const config::Signal& signal) {
  const std::optional<config::ModbusPlace> place = modbus_place(drive, signal);
  if (!place) {
    return nullptr;
  }
  json::object object{{"kind", place->kind == config::ModbusKind::bit ? "bit" : "register"},
                      {"address", place->address},
                      {"count", place->count}};
  if (const std::optional<std::uint16_t> flat = flat_address(model, drive, signal)) {
    object["flat"] = *flat;
  }
  return object;
}

json::object json_signal(const config::Model& model, const config::Drive& drive, const config::Signal& signal) {
  json::object object;
  object["name"] = signal.name;
  object["object"] = canopen::to_string(signal.object);
  object["type"] = canopen::name_of(signal.type);
  object["scale"] = signal.scale;
  object["unit"] = signal.unit;
  object["access"] = to_text(signal.access);
  object["source"] = to_text(signal.source);
  object["min"] = value_or_null(signal.min);
  object["max"] = value_or_null(signal.max);
  object["values"] = json_values(signal);
  object["modbus"] = json_modbus(model, drive, signal);
  object["mqtt"] = {{"topic", value_or_null(value_topic(model, drive, signal))},
                    {"set", value_or_null(set_topic(model, drive, signal))}};
  object["unconfirmed"] = signal.unconfirmed;
  return object;
}

json::object json_drive(const config::Model& model, const config::Drive& drive) {
  json::object object;
  object["name"] = drive.name;
  object["bus"] = model.buses.at(drive.bus).name;
  object["node"] = drive.node.node;
  object["profile"] = drive.profile;
  object["modbus_unit"] = value_or_null(drive.unit);
  if (drive.flat) {
    object["flat"] = *drive.flat;
  }
  json::array& signals = object["signals"].emplace_array();
  for (const config::Signal& signal : drive.signals) {
    signals.emplace_back(json_signal(model, drive, signal));
  }
  return object;
}

void append_value(std::string& out, const json::value& value, std::size_t depth);

void append_object(std::string& out, const json::object& object, std::size_t depth) {
  out += '{';
  bool first = true;
  for (const auto& [key, value] : object) {
    out += std::exchange(first, false) ? "" : ", ";
    out += json::serialize(key) + ": ";
    append_value(out, value, depth);
  }
  out += '}';
}

// Its elements on lines of their own.
void append_array(std::string& out, const json::array& array, std::size_t depth) {
  out += '[';
  bool first = true;
  for (const json::value& element : array) {
    out += std::exchange(first, false) ? "\n" : ",\n";
    out.append(2 * (depth + 1), ' ');
    append_value(out, element, depth + 1);
  }
  out += ']';
}

// Boost.JSON's own serializer writes 0.01 as 1E-2, which nobody likes to read.
void append_value(std::string& out, const json::value& value, std::size_t depth) {
  if (value.is_object()) {
    append_object(out, value.get_object(), depth);
  } else if (value.is_array()) {
    append_array(out, value.get_array(), depth);
  } else if (value.is_double()) {
    out += config::to_text(value.get_double());
  } else {
    out += json::serialize(value);
  }
}

}  // namespace

std::string render_map_json(const config::Model& model) {
  json::object map;
  map["gateway"] = model.gateway.name;
  map["base"] = base_topic(model);
  if (model.modbus && model.modbus->flat_unit) {
    map["flat_unit"] = *model.modbus->flat_unit;
  }
  json::array& buses = map["buses"].emplace_array();
  for (std::size_t bus = 0; bus < model.buses.size(); ++bus) {
    buses.emplace_back(json_bus(model, bus));
  }
  json::array& drives = map["drives"].emplace_array();
  for (const config::Drive& drive : model.drives) {
    drives.emplace_back(json_drive(model, drive));
  }
  std::string out;
  append_object(out, map, 0);
  return out + "\n";
}

}  // namespace gateway
