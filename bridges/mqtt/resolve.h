#pragma once

#include <functional>
#include <string>
#include <vector>

#include "config/model.h"

namespace mqtt {

/// Numeric addresses of a host, IPv6 without brackets, best first; empty where there are none. Blocks, with a bad name
/// server for long: called in the publisher's thread only. Paho gets a numeric address, because while it resolves a
/// name itself every other call into it waits.
using Resolver = std::function<std::vector<std::string>(const config::Endpoint&)>;

[[nodiscard]] std::vector<std::string> resolve(const config::Endpoint& endpoint);

}  // namespace mqtt
