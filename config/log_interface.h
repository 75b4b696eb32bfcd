#pragma once

#include <string_view>

#include "config/model.h"

namespace config {

/// The name of a bus in a candump log: its interface, which for in-process buses, all of which have the same, is their
/// name.
[[nodiscard]] inline std::string_view log_interface(const Bus& bus) noexcept {
  return bus.interface == kVirtualInterface ? std::string_view(bus.name) : std::string_view(bus.interface);
}

}  // namespace config
