#include "bridges/process/health.h"

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

void append_text_or_null(text::ObjectText& object, std::string_view name, const std::optional<std::string>& value) {
  if (value) {
    object.text(name, *value);
  } else {
    object.null(name);
  }
}

void append_buses(std::string& out, const std::vector<BusHealth>& buses) {
  out += '[';
  bool first = true;
  for (const BusHealth& bus : buses) {
    text::append_separator(out, first);
    text::ObjectText object(out);
    object.text("name", bus.name);
    object.text("state", name_of(bus.condition));
    object.number("load", bus.load);
    object.close();
  }
  out += ']';
}

void append_broker(text::ObjectText& object, const BrokerHealth& broker) {
  append_text_or_null(object, "broker", broker.broker);
  append_text_or_null(object, "protocol", broker.protocol);
  std::string& refused = object.key("refused_subscriptions");
  refused += '[';
  bool first = true;
  for (const std::string& filter : broker.refused) {
    text::append_separator(refused, first);
    text::append_quoted(refused, filter);
  }
  refused += ']';
  append_text_or_null(object, "last_break",
                      broker.last_break.empty() ? std::nullopt : std::optional(broker.last_break));
  append_text_or_null(object, "another_instance", broker.other);
  object.integer("put_right", static_cast<std::int64_t>(broker.put_right));
  object.integer("messages_dropped", static_cast<std::int64_t>(broker.messages_dropped));
  object.integer("answers_dropped", static_cast<std::int64_t>(broker.answers_dropped));
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
  for (std::size_t i = 0; i < plant.model().buses.size(); ++i) {
    const config::Bus& bus = plant.model().buses[i];
    BusHealth& shown = health.buses.emplace_back();
    shown.name = bus.name;
    shown.condition = plant.bus_state(i).condition;
    if (bus.bitrate) {
      shown.load = plant.bus_statistics(i).load_per_mille / 1000.0;
    }
  }
  return health;
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
  append_buses(object.key("buses"), health.buses);
  object.integer("drives", static_cast<std::int64_t>(health.drives));
  object.integer("drives_online", static_cast<std::int64_t>(health.online));
  if (health.broker) {
    append_broker(object, *health.broker);
  }
  object.integer("log_messages_lost", static_cast<std::int64_t>(health.program.log_lost));
  object.integer("memory", static_cast<std::int64_t>(health.program.memory));
  append_text_or_null(object, "journal",
                      health.program.journal.empty() ? std::nullopt : std::optional(health.program.journal));
  object.close();
  return out;
}

}  // namespace process
