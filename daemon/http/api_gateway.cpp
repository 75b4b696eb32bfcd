#include <ranges>
#include <string>

#include "bridges/text/json_text.h"
#include "daemon/bus_report.h"
#include "daemon/http/respond.h"

namespace gateway::http {
namespace {

using text::ObjectText;

void append_figures_of_bus(std::string& out, const Site& site, std::size_t index) {
  const process::Plant& plant = site.plant;
  const config::Bus& bus = plant.model().buses[index];
  const canopen::BusState& state = plant.bus_state(index);
  const canopen::BusStatistics counted = plant.bus_statistics(index);
  ObjectText object(out);
  object.text("name", bus.name);
  object.text("interface", bus.interface);
  if (counted.bitrate != 0) {
    object.number("highest_load", counted.highest_load_per_mille / 1000.0);
  } else {
    object.null("highest_load");
  }
  object.integer("transmit_errors", state.transmit_errors);
  object.integer("receive_errors", state.receive_errors);
  object.integer("error_frames", counted.error_frames);
  object.integer("bus_off_events", counted.bus_offs);
  object.integer("frames_received", counted.frames_received);
  object.integer("frames_sent", counted.frames_sent);
  object.integer("frames_lost", counted.frames_lost);
  append_bus_summary(object, plant, index, site.survey);
  object.close();
}

void append_modbus_figures(ObjectText& to, const Site& site) {
  if (!site.modbus) {
    to.null("modbus");
    return;
  }
  const ModbusFigures figures = site.modbus();
  std::uint64_t exceptions = 0;
  for (const std::uint64_t count : figures.counts.exceptions) {
    exceptions += count;
  }
  ObjectText object(to.key("modbus"));
  object.integer("clients", figures.clients);
  object.integer("refused", figures.refused);
  object.integer("requests", figures.counts.requests);
  object.integer("exceptions", exceptions);
  object.close();
}

void append_mqtt_figures(ObjectText& to, const Site& site) {
  if (!site.mqtt) {
    to.null("mqtt");
    return;
  }
  const MqttFigures figures = site.mqtt();
  ObjectText object(to.key("mqtt"));
  object.boolean("connected", figures.connected);
  object.integer("published", figures.counts.published);
  object.close();
}

void append_journal_figures(ObjectText& to, const Site& site) {
  if (!site.journal) {
    to.null("journal");
    return;
  }
  const JournalFigures figures = site.journal();
  ObjectText object(to.key("journal"));
  object.integer("lost", figures.lost);
  object.integer("passed_by", figures.passed_by);
  object.close();
}

void append_http_figures(ObjectText& to, const Site& site) {
  if (!site.http) {
    to.null("http");
    return;
  }
  const HttpFigures figures = site.http();
  ObjectText object(to.key("http"));
  object.integer("clients", figures.clients);
  object.integer("refused", figures.refused);
  object.close();
}

}  // namespace

Answer gateway_figures(const Site& site) {
  Answer answer;
  ObjectText object(answer.body);
  object.text("name", site.plant.model().gateway.name);
  object.text("version", site.version);
  object.integer("configuration", site.plant.changes());
  object.key("health") += process::health_json(site.health());
  text::append_list(object.key("buses"), std::views::iota(std::size_t{0}, site.plant.model().buses.size()),
                    [&site](std::string& to, std::size_t bus) { append_figures_of_bus(to, site, bus); });
  append_modbus_figures(object, site);
  append_mqtt_figures(object, site);
  append_journal_figures(object, site);
  append_http_figures(object, site);
  object.close();
  return answer;
}

}  // namespace gateway::http
