#include "bridges/mqtt/info.h"

#include <optional>
#include <ranges>
#include <string>
#include <vector>

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

void append_signal(std::string& out, const config::Signal& signal, const std::string& topic, bool published) {
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
  object.text("topic", config::readable(signal.access) && published ? std::optional(topic) : std::nullopt);
  object.text("set", config::writable(signal.access) ? std::optional(topic + "/set") : std::nullopt);
  if (signal.unconfirmed) {
    object.boolean("unconfirmed", true);  // the profile could not establish its meaning or scale
  }
  object.close();
}

// Those whose layout nobody wrote and nobody can read: what they carry is what the profile says.
void append_assumed(std::string& out, const config::Drive& drive) {
  std::vector<std::string> assumed;
  const auto add = [&assumed](std::string_view kind, const std::vector<canopen::PdoSettings>& pdos) {
    for (const canopen::PdoSettings& pdo : pdos) {
      if (pdo.mapping_policy == canopen::SetupPolicy::assume) {
        assumed.push_back(std::string(kind) + std::to_string(pdo.number));
      }
    }
  };
  add("TPDO", drive.node.tpdos);
  add("RPDO", drive.node.rpdos);
  text::append_list(out, assumed, [](std::string& list, const std::string& name) { text::append_quoted(list, name); });
}

void append_drive(std::string& out, const config::Model& model, const config::Drive& drive, const DriveTopics& topics) {
  text::ObjectText object(out);
  object.text("name", drive.name);
  object.text("bus", model.buses.at(drive.bus).name);
  object.integer("node", drive.node.node);
  object.text("profile", drive.profile);
  object.integer("modbus_unit", drive.unit);
  object.boolean("commands", drive.commands.writers.mqtt);
  append_assumed(object.key("assumed_pdos"), drive);
  const bool published = !model.mqtt || model.mqtt->signals;
  text::append_list(object.key("signals"), std::views::iota(std::size_t{0}, drive.signals.size()),
                    [&](std::string& list, std::size_t i) {
                      append_signal(list, drive.signals[i], topics.signals.at(i), published);
                    });
  object.close();
}

void append_bus(std::string& out, const config::Bus& bus) {
  text::ObjectText object(out);
  object.text("name", bus.name);
  object.text("interface", bus.interface);
  object.integer("bitrate", bus.bitrate);
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
  const std::string& prefix = model.mqtt ? model.mqtt->home_assistant : std::string();
  object.text("home_assistant", prefix.empty() ? std::nullopt : std::optional(prefix));
  text::append_list(object.key("buses"), model.buses, append_bus);
  text::append_list(
      object.key("drives"), std::views::iota(std::size_t{0}, model.drives.size()),
      [&](std::string& list, std::size_t i) { append_drive(list, model, model.drives[i], topics.drive(i)); });
  object.close();
  return out;
}

}  // namespace mqtt
