#pragma once

#include <optional>
#include <string_view>

#include "config/model.h"
#include "config/schema/form.h"

namespace config {

/// `0.0.0.0:502`, `[::]:502`, `localhost:1502`. Digits and dots alone must be a whole IPv4 address.
[[nodiscard]] std::optional<Endpoint> parse_endpoint(std::string_view text);

[[nodiscard]] Form<Endpoint> endpoint();
/// `mqtt://HOST:PORT`
[[nodiscard]] Form<Endpoint> broker();
/// `10.0.0.0/8`, `::1/128`, or one address; without bits beyond its prefix, and no IPv4 in the clothes of IPv6.
[[nodiscard]] Form<Network> network();

/// A socket bound to `outer` takes the connections to `inner`, too.
[[nodiscard]] bool covers(const Endpoint& outer, const Endpoint& inner);
/// Every address of `inner` is one of `outer`.
[[nodiscard]] bool covers(const Network& outer, const Network& inner);

}  // namespace config
