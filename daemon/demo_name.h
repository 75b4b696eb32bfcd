#pragma once

#include <string>
#include <string_view>

namespace gateway {

/// What a demo of the gateway `name` calls itself, so that nobody takes it for the plant: `line3-demo`. The tail of a
/// long name gives way. Never the same name.
[[nodiscard]] std::string demo_name(std::string_view name);

}  // namespace gateway
