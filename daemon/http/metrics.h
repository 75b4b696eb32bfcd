#pragma once

#include "daemon/http/answer.h"
#include "daemon/http/families.h"
#include "daemon/http/site.h"

namespace gateway::http {

/// `/metrics`
[[nodiscard]] Answer metrics(const Site& site);

// Its parts.
void add_buses(Families& families, const process::Plant& plant);
void add_drives(Families& families, const process::Plant& plant, canopen::TimePoint now);
void add_alarms(Families& families, const process::Plant& plant);
void add_commands(Families& families, const Site& site);
void add_servers(Families& families, const Site& site);
void add_program(Families& families, const Site& site);

}  // namespace gateway::http
