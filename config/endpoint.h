#pragma once

#include <optional>
#include <string_view>

#include "config/model.h"

namespace config {

/// `0.0.0.0:502`, `[::]:502`, `localhost:1502`.
[[nodiscard]] std::optional<Endpoint> parse_endpoint(std::string_view text);
/// `10.0.0.0/8`, `::1/128`, or one address. Nothing where it is no numeric address or the prefix is too long.
[[nodiscard]] std::optional<Network> parse_network(std::string_view text);
/// The same network without bits beyond its prefix: 10.0.0.5/8 gives 10.0.0.0/8.
[[nodiscard]] Network masked(const Network& network);

}  // namespace config
