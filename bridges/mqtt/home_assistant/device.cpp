#include "bridges/mqtt/home_assistant/device.h"

#include <array>
#include <vector>

#include "bridges/mqtt/home_assistant/commands.h"
#include "bridges/mqtt/home_assistant/entity.h"
#include "bridges/mqtt/home_assistant/readings.h"
#include "bridges/text/json_text.h"

namespace mqtt::home_assistant {
namespace {

using text::ObjectText;

// By the drive's name alone two lines that name their drives alike would show the same there.
void append_device(std::string& out, const config::Drive& drive, std::string_view gateway, const DriveTopics& topics) {
  ObjectText device(out);
  text::append_list(device.key("identifiers"), std::array{std::string_view(topics.root)},
                    [](std::string& list, std::string_view id) { text::append_quoted(list, id); });
  device.text("name", std::string(gateway).append(" ").append(drive.name));
  device.text("model", drive.profile);
  device.close();
}

void append_origin(std::string& out, std::string_view version) {
  ObjectText origin(out);
  origin.text("name", "canopen-gateway");
  origin.text("sw_version", version);
  origin.close();
}

void append_topic(std::string& out, std::string_view topic) {
  ObjectText available(out);
  available.text("topic", topic);
  available.close();
}

// One that has nothing but its platform is removed.
void append_gone(std::string& out, std::string_view platform) {
  ObjectText removed(out);
  removed.text("platform", platform);
  removed.close();
}

}  // namespace

Device device_of(const config::Drive& drive, const Topics& topics, std::size_t index, const config::Mqtt& settings,
                 std::string_view version, const Entities& before) {
  const DriveTopics& of_drive = topics.drive(index);
  std::vector<Entity> entities;
  append_readings(entities, drive, of_drive, settings);
  if (drive.commands.writers.mqtt) {
    append_commands(entities, drive, of_drive);
  }
  Device device;
  ObjectText message(device.message);
  append_device(message.key("device"), drive, topics.gateway(), of_drive);
  append_origin(message.key("origin"), version);
  text::append_list(message.key("availability"), std::array{topics.status(), of_drive.status}, append_topic);
  message.text("availability_mode", "all");
  message.text("state_topic", of_drive.state);
  ObjectText components(message.key("components"));
  for (Entity& entity : entities) {
    components.key(entity.key) += entity.config;
    device.entities.emplace(std::move(entity.key), std::move(entity.platform));
  }
  for (const auto& [key, platform] : before) {
    if (!device.entities.contains(key)) {
      append_gone(components.key(key), platform);
    }
  }
  components.close();
  message.close();
  return device;
}

}  // namespace mqtt::home_assistant
