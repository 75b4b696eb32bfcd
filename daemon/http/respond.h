#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/model.h"
#include "daemon/http/answer.h"
#include "daemon/http/request.h"
#include "daemon/http/site.h"

namespace gateway::http {

/// What is answered to a request: looks, and changes nothing. Never waits.
[[nodiscard]] Answer respond(const Request& request, const Site& site);

/// What there is in place of a drive that there is not.
[[nodiscard]] std::vector<std::string> drive_names(const config::Model& model);

// One for each resource. `target` has the parameters that it knows.
[[nodiscard]] Answer health(const Site& site);
[[nodiscard]] Answer gateway_figures(const Site& site);
[[nodiscard]] Answer buses(const Site& site);
[[nodiscard]] Answer drives(const Site& site);
[[nodiscard]] Answer drive(const Site& site, std::string_view name);
[[nodiscard]] Answer active_alarms(const Site& site);
[[nodiscard]] Answer map(const Site& site);
[[nodiscard]] Answer history(const Site& site, const Target& target);
[[nodiscard]] Answer trace_frames(const Site& site, const Target& target);
[[nodiscard]] Answer commands(const Site& site, const Target& target);
[[nodiscard]] Answer records(const Site& site);
/// The log or the JSON of a record.
[[nodiscard]] Answer record_file(const Site& site, std::string_view name);

}  // namespace gateway::http
