#pragma once

#include "config/schema/section.h"
#include "config/toml/document.h"

namespace config {

/// Lays the table `upper` over `lower`, each key as the section says. Values keep the place they came from. Keys that
/// the section does not know are replaced; they have their finding.
void lay_over(Node& lower, const Node& upper, const Section& section);

}  // namespace config
