#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "bridges/mqtt/topics.h"
#include "bridges/text/json_text.h"
#include "config/model.h"

// After Home Assistant's documentation of its MQTT integration and of the platforms sensor, binary_sensor, number,
// select and button; which unit and which state class goes with which device class, after that of its sensor
// integration.

namespace mqtt::home_assistant {

/// All that we use.
inline constexpr std::array<std::string_view, 5> kPlatforms{"sensor", "binary_sensor", "number", "select", "button"};

/// Something of a drive that Home Assistant shows, or lets people command.
struct Entity {
  std::string platform;
  std::string key;       ///< Names it among those of its drive; begins with the platform.
  std::string config{};  ///< A JSON object.
};

/// One with what all have, and with what `write(object)` adds. `name` is unique among those of the platform.
template <class Write>
Entity entity_of(const DriveTopics& topics, std::string_view platform, std::string_view name, std::string_view label,
                 Write write) {
  Entity entity{.platform = std::string(platform), .key = std::string(platform).append("_").append(name)};
  text::ObjectText object(entity.config);
  object.text("platform", platform);
  object.text("unique_id", topics.root + "/" + entity.key);
  object.text("name", label);
  write(object);
  object.close();
  return entity;
}

/// `Output frequency`, of `output_frequency`.
[[nodiscard]] std::string label_of(std::string_view signal);
/// The value of a signal, in a template. Not `value_json.values`, which is a method of the dictionary.
[[nodiscard]] std::string value_of(std::string_view signal);
/// `{{ VALUE if CONDITION else None }}`: where the condition does not hold the entity is `unknown`.
[[nodiscard]] std::string template_of(const std::string& value, const std::string& condition);
/// The number of a name is among these: `1, 2`. By numbers, because names may hold anything.
[[nodiscard]] std::string code_is_among(std::string_view signal, const std::string& codes);
/// Unit and device class of a number with a unit; the class only where that unit can mean nothing else.
void append_unit(text::ObjectText& object, const std::string& unit);
[[nodiscard]] bool is_energy(std::string_view unit) noexcept;

}  // namespace mqtt::home_assistant
