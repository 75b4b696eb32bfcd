#pragma once

#include "config/model.h"
#include "config/schema/section.h"

namespace config {

/// The keys of the gateway's own file.
[[nodiscard]] const Section& site_section();
[[nodiscard]] const SectionOf<Gateway>& gateway_section();
[[nodiscard]] const SectionOf<Bus>& bus_section();
[[nodiscard]] const SectionOf<Modbus>& modbus_section();
[[nodiscard]] const SectionOf<Mqtt>& mqtt_section();
[[nodiscard]] const SectionOf<Http>& http_section();
[[nodiscard]] const SectionOf<Recorder>& recorder_section();

/// `exception`, `hold`, `zero`
[[nodiscard]] Form<OnStale> on_stale_form();

}  // namespace config
