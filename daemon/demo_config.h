#pragma once

#include <string_view>

namespace gateway {

/// config/demo.toml as it was when the program was built.
[[nodiscard]] std::string_view demo_config() noexcept;

}  // namespace gateway
