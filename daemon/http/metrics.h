#pragma once

#include "daemon/http/answer.h"
#include "daemon/http/families.h"
#include "daemon/http/site.h"

namespace gateway::http {

/// `/metrics`
[[nodiscard]] Answer metrics(const Site& site);
/// Error frames among the newest ErrorShare::kWindow frames, or among all where there were fewer: 0 to 1.
[[nodiscard]] double error_share(const canopen::BusStatistics& counted);

// Its parts; those of drives for one drive at a time.
void add_buses(Families& families, const process::Plant& plant);
void add_bus_health(Families& families, const Site& site);
void add_drive(Families& families, const process::Plant& plant, const process::Drive& drive, canopen::TimePoint now);
void add_drive_health(Families& families, const Site& site, const process::Drive& drive);
void add_alarm_counts(Families& families, const process::Plant& plant);
void add_alarms(Families& families, const process::Drive& drive);
void add_commands(Families& families, const Site& site, const process::Drive& drive);
void add_servers(Families& families, const Site& site);
void add_program(Families& families, const Site& site);

}  // namespace gateway::http
