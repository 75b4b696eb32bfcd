#include "bridges/mqtt/info.h"

#include "bridges/text/json_text.h"
#include "canopen/object.h"

namespace mqtt {
namespace {

void append_names(text::ObjectText& object, const config::Signal& signal) {
  if (signal.values.empty()) {
    object.null("values");
    return;
  }
  text::ObjectText names(object.key("values"));
  for (const auto& [raw, name] : signal.values) {
    names.text(std::to_string(raw), name);
  }
  names.close();
}

void append_signal(std::string& out, const config::Signal& signal, const std::string& topic) {
  text::ObjectText object(out);
  object.text("name", signal.name);
  object.text("object", canopen::to_string(signal.object));
  object.text("type", canopen::name_of(signal.derived ? canopen::DataType::boolean : signal.type));
  object.number("scale", signal.scale);
  object.text("unit", signal.unit);
  object.text("access", to_text(signal.access));
  object.text("source", to_text(signal.source));
  object.number("min", signal.min);
  object.number("max", signal.max);
  append_names(object, signal);
  if (config::readable(signal.access)) {
    object.text("topic", topic);
  } else {
    object.null("topic");
  }
  if (config::writable(signal.access)) {
    object.text("set", topic + "/set");
  } else {
    object.null("set");
  }
  if (signal.unconfirmed) {
    object.boolean("unconfirmed", true);  // the profile could not establish its meaning or scale
  }
  object.close();
}

void append_drive(std::string& out, const config::Model& model, const config::Drive& drive, const DriveTopics& topics) {
  text::ObjectText object(out);
  object.text("name", drive.name);
  object.text("bus", model.buses.at(drive.bus).name);
  object.integer("node", drive.node.node);
  object.text("profile", drive.profile);
  if (drive.unit) {
    object.integer("modbus_unit", *drive.unit);
  } else {
    object.null("modbus_unit");
  }
  object.boolean("commands", drive.commands.writers.mqtt);
  std::string& list = object.key("signals");
  list += '[';
  bool first = true;
  for (std::size_t i = 0; i < drive.signals.size(); ++i) {
    text::append_separator(list, first);
    append_signal(list, drive.signals[i], topics.signals.at(i));
  }
  list += ']';
  object.close();
}

void append_bus(std::string& out, const config::Bus& bus) {
  text::ObjectText object(out);
  object.text("name", bus.name);
  object.text("interface", bus.interface);
  if (bus.bitrate) {
    object.integer("bitrate", *bus.bitrate);
  } else {
    object.null("bitrate");
  }
  object.integer("node_id", bus.node_id);
  object.close();
}

}  // namespace

std::string info_json(const config::Model& model, const Topics& topics, std::string_view version,
                      std::string_view instance) {
  std::string out;
  text::ObjectText object(out);
  object.text("version", version);
  object.text("instance", instance);
  object.text("gateway", model.gateway.name);
  object.text("base", topics.root());
  object.key("buses") += '[';
  bool first = true;
  for (const config::Bus& bus : model.buses) {
    text::append_separator(out, first);
    append_bus(out, bus);
  }
  out += ']';
  object.key("drives") += '[';
  first = true;
  for (std::size_t i = 0; i < model.drives.size(); ++i) {
    text::append_separator(out, first);
    append_drive(out, model, model.drives[i], topics.drive(i));
  }
  out += ']';
  object.close();
  return out;
}

}  // namespace mqtt
