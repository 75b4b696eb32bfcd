#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "config/model.h"
#include "config/schema/form.h"

namespace config {

/// `0.0.0.0:502`, `[::]:502`, `localhost:1502`. A host that ends in a number must be an IPv4 address; multicast and
/// broadcast addresses and IPv4 in the clothes of IPv6 are none. Names in lower case.
[[nodiscard]] std::optional<Endpoint> parse_endpoint(std::string_view text);

/// `port`: of the example in its complaint.
[[nodiscard]] Form<Endpoint> endpoint(std::uint16_t port = 502);
/// `line3.plant.example`, or a numeric address; without a port. In lower case, addresses in their one spelling.
[[nodiscard]] Form<std::string> host();
/// `mqtt://HOST:PORT`, or `mqtts://HOST:PORT` for TLS
[[nodiscard]] Form<Endpoint> broker();
/// `10.0.0.0/8`, `::1/128`, or one address; without bits beyond its prefix, and no IPv4 in the clothes of IPv6.
[[nodiscard]] Form<Network> network();

/// An address of one link alone (RFC 4291, section 2.5.6): fe80::/10.
[[nodiscard]] bool is_link_local(const Endpoint& endpoint);

/// A socket bound to `outer` takes the connections to `inner`, too.
[[nodiscard]] bool covers(const Endpoint& outer, const Endpoint& inner);
/// Every address of `inner` is one of `outer`.
[[nodiscard]] bool covers(const Network& outer, const Network& inner);
/// Some address is in both.
[[nodiscard]] bool meet(const Network& one, const Network& other);
/// A client of this network can connect to a socket that listens there.
[[nodiscard]] bool can_arrive(const Network& from, const Endpoint& listen);

}  // namespace config
