#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "config/model.h"

namespace gateway {

/// TCP ports that a demo leaves alone.
using Ports = std::set<std::uint16_t>;

enum class DemoOf : std::uint8_t {
  itself,     ///< The configuration that the program has built in, which is no plant's and named so.
  given_site  ///< A file, which may be a plant's whatever it is called.
};

/// Makes a site a demo of it, which nobody takes for the plant: another name (demo_name()), another client id, loopback
/// addresses and brokers only, nothing announced to Home Assistant, and never the ports of a plant: 502, 9464, and
/// those that the site names. A site whose buses are all virtual has no plant: it keeps its loopback ports. HTTP is on
/// whatever the site says. Returns the ports of a plant.
[[nodiscard]] Ports make_demo(config::Model& model, DemoOf of);

/// Puts what is taken on this machine to the next free port that is no plant's; what was changed, for people, a line
/// each.
[[nodiscard]] std::vector<std::string> step_aside(config::Model& model, const Ports& plant);

}  // namespace gateway
