#include "bridges/process/health.h"

#include <algorithm>
#include <chrono>
#include <string_view>

#include "bridges/alarms/reason.h"
#include "bridges/process/plant.h"
#include "bridges/text/json_text.h"
#include "bridges/text/timestamp.h"

namespace process {
namespace {

// As the reason of its alarm.
std::string_view name_of(canopen::BusCondition condition) noexcept {
  return condition == canopen::BusCondition::error_active ? "active" : alarms::bus_reason(condition);
}

std::optional<std::string_view> unless_empty(std::string_view text) {
  return text.empty() ? std::nullopt : std::optional(text);
}

void append_bus(std::string& out, const BusHealth& bus) {
  text::ObjectText object(out);
  object.text("name", bus.name);
  object.text("state", name_of(bus.condition));
  object.number("load", bus.load);
  object.close();
}

void append_broker(text::ObjectText& object, const BrokerHealth& broker) {
  object.text("broker", broker.broker);
  object.text("protocol", broker.protocol);
  text::append_list(object.key("refused_subscriptions"), broker.refused, text::append_quoted);
  object.text("last_break", unless_empty(broker.last_break));
  object.text("another_instance", broker.other);
  object.integer("put_right", broker.put_right);
  object.integer("messages_dropped", broker.messages_dropped);
  object.integer("answers_dropped", broker.answers_dropped);
}

// What is measured anew each time, and so tells nothing by being different.
Health without_measures(Health health) {
  health.ts = {};
  health.program.uptime = {};
  health.program.memory = 0;
  for (BusHealth& bus : health.buses) {
    bus.load.reset();
  }
  return health;
}

}  // namespace

Health health_of(const Plant& plant) {
  Health health{.ts = canopen::wall_now(), .drives = plant.size(), .online = plant.online()};
  health.in_service = static_cast<std::size_t>(std::ranges::count(plant.model().drives, true, &config::Drive::enabled));
  for (std::size_t i = 0; i < plant.model().buses.size(); ++i) {
    const config::Bus& bus = plant.model().buses[i];
    BusHealth& shown = health.buses.emplace_back();
    shown.name = bus.name;
    shown.condition = plant.bus_state(i).condition;
    shown.in_service = std::ranges::any_of(plant.model().drives,
                                           [i](const config::Drive& drive) { return drive.enabled && drive.bus == i; });
    if (const canopen::BusStatistics statistics = plant.bus_statistics(i); statistics.bitrate != 0) {
      shown.load = statistics.load_per_mille / 1000.0;
    }
  }
  return health;
}

bool is_well(const Health& health) {
  const auto is_well = [](const BusHealth& bus) {
    return !bus.in_service || canopen::BusState{.condition = bus.condition}.up();
  };
  return std::ranges::all_of(health.buses, is_well) && (health.in_service == 0 || health.online > 0);
}

bool differs(const Health& one, const Health& other) {
  return without_measures(one) != without_measures(other);
}

std::string health_json(const Health& health) {
  std::string out;
  text::ObjectText object(out);
  object.text("ts", text::timestamp(health.ts));
  object.text("instance", health.instance);
  if (!health.program.clock_set) {
    object.text("clock", "unset");
  }
  object.integer("uptime", std::chrono::floor<std::chrono::seconds>(health.program.uptime).count());
  text::append_list(object.key("buses"), health.buses, append_bus);
  object.integer("drives", health.drives);
  object.integer("drives_online", health.online);
  if (health.broker) {
    append_broker(object, *health.broker);
  }
  object.integer("log_messages_lost", health.program.log_lost);
  object.integer("memory", health.program.memory);
  object.text("journal", unless_empty(health.program.journal));
  object.close();
  return out;
}

}  // namespace process
