#pragma once

#include "config/schema/section.h"
#include "config/toml/document.h"

namespace config {

/// Lays the table `upper` over `lower`, each key as the section says. Values keep the place they came from; keys take
/// the upper one's, so that a finding about a signal stands where the site speaks of it. What the section does not
/// know, or wants as a table and is none, has its finding already.
void lay_over(Node& lower, const Node& upper, const Section& section);

}  // namespace config
