#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "bridges/mqtt/topics.h"
#include "config/model.h"

namespace mqtt::home_assistant {

/// Platforms of entities by their keys.
using Entities = std::map<std::string, std::string, std::less<>>;

/// What Home Assistant is told of one drive: a device with its entities.
struct Device {
  std::string message;  ///< JSON, for the drive's discovery topic.
  Entities entities;    ///< That are in it, without those that it removes.
};

/// `before`: entities that Home Assistant may know; those that are no more are removed.
[[nodiscard]] Device device_of(const config::Drive& drive, const Topics& topics, std::size_t index,
                               const config::Mqtt& settings, std::string_view version, const Entities& before);

/// The entities of a message that a broker keeps, but for those that it removes; nothing where it is no message of the
/// gateway whose status lies there. Whatever the bytes are.
[[nodiscard]] std::optional<Entities> read_kept_device(std::string_view message, std::string_view status);

}  // namespace mqtt::home_assistant
