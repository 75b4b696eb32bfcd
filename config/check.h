#pragma once

#include <string>
#include <string_view>

#include "config/document.h"
#include "config/report.h"
#include "config/schema.h"

namespace config {

/// Compares a table with its section: unknown and missing keys, types, ranges, notations, and keys that this version
/// does not know yet. What one key means beside another is for those who read them. `where` begins every finding:
/// `profile "x"`, or empty.
void check(const Node& table, const Section& section, std::string_view where, Report& report);

}  // namespace config
