#include <utility>

#include "canopen/hex.h"
#include "daemon/http/metrics.h"

namespace gateway::http {
namespace {

template <class Value>
void take_one(Families& families, Family family, Value value) {
  family.add({}, value);
  families.take(std::move(family));
}

void add_modbus(Families& families, const ModbusFigures& figures) {
  take_one(families, Families::gauge("modbus_clients", "Modbus clients connected now."),
           std::uint64_t{figures.clients});
  take_one(families, Families::counter("modbus_refused_clients_total", "Modbus connections that were refused."),
           figures.refused);
  take_one(families,
           Families::counter("modbus_garbage_total",
                             "Modbus connections that were ended since they sent what is no Modbus TCP."),
           figures.counts.garbage);
  take_one(families, Families::counter("modbus_requests_total", "Modbus requests answered, exceptions included."),
           figures.counts.requests);
  Family exceptions =
      Families::counter("modbus_exceptions_total", "Modbus requests answered with an exception, by code.");
  for (const modbus::Exception code :
       {modbus::Exception::illegal_function, modbus::Exception::illegal_address, modbus::Exception::illegal_value,
        modbus::Exception::device_failure, modbus::Exception::unknown_unit, modbus::Exception::no_response}) {
    const auto number = static_cast<std::uint8_t>(code);
    exceptions.add({{"code", "0x" + canopen::hex(number, 2)}}, figures.counts.exceptions.at(number));
  }
  families.take(std::move(exceptions));
}

void add_mqtt(Families& families, const MqttFigures& figures) {
  take_one(families, Families::gauge("mqtt_connected", "1: connected to a broker, and everything was published."),
           figures.connected);
  take_one(families, Families::counter("mqtt_messages_published_total", "Messages that the broker has taken."),
           figures.counts.published);
  take_one(families,
           Families::counter("mqtt_messages_dropped_total", "Messages that the broker refused or could not take."),
           figures.counts.messages_dropped);
  take_one(families,
           Families::counter("mqtt_answers_dropped_total",
                             "Answers to commands that were too old, tried too often, or too many."),
           figures.counts.answers_dropped);
  take_one(families, Families::counter("mqtt_topics_put_right_total", "Topics that somebody else had overwritten."),
           figures.put_right);
  take_one(families, Families::gauge("mqtt_refused_subscriptions", "Subscriptions that the broker refuses now."),
           std::uint64_t{figures.refused_subscriptions});
}

void add_http(Families& families, const HttpFigures& figures) {
  take_one(families, Families::gauge("http_clients", "HTTP clients connected now."), std::uint64_t{figures.clients});
  take_one(families, Families::counter("http_refused_clients_total", "HTTP connections that were refused."),
           figures.refused);
  Family answers = Families::counter("http_answers_total", "HTTP requests answered, by status.");
  for (const auto& [status, count] : figures.answers) {
    answers.add({{"status", std::to_string(status)}}, count);
  }
  families.take(std::move(answers));
}

}  // namespace

void add_servers(Families& families, const Site& site) {
  if (site.modbus) {
    add_modbus(families, site.modbus());
  }
  if (site.mqtt) {
    add_mqtt(families, site.mqtt());
  }
  if (site.journal) {
    const JournalFigures journal = site.journal();
    take_one(families,
             Families::counter("journal_lines_lost_total", "Lines of the journal of commands that were never written."),
             journal.lost);
    take_one(families,
             Families::counter("journal_passed_by_total", "Commands that did not wait for their line in the journal."),
             journal.passed_by);
  }
  if (site.recorder) {
    const RecorderFigures recorder = site.recorder();
    take_one(families,
             Families::gauge("recorder_works", "0: the last record could not be kept, or the disk does not answer."),
             recorder.works);
    take_one(families, Families::counter("recorder_records_lost_total", "Records that were given up."), recorder.lost);
  }
  if (site.http) {
    add_http(families, site.http());
  }
}

void add_program(Families& families, const Site& site) {
  const process::Health health = site.health();
  Family info = Families::gauge("info", "1; the labels tell which gateway this is.");
  info.add({{"gateway", site.plant.model().gateway.name}, {"version", site.version}, {"instance", health.instance}},
           true);
  families.take(std::move(info));
  take_one(families, Families::gauge("healthy", "1: /health answers 200, 0: 503."), process::is_well(health));
  take_one(families, Families::gauge("clock_set", "0: nobody set the time of day since the machine started."),
           health.program.clock_set);
  take_one(families, Families::counter("log_messages_lost_total", "Messages that the log lost."),
           health.program.log_lost);
  const ProcessFigures figures = site.process();
  take_one(families, Families::counter("process_cpu_seconds_total", "Processor time used, user and system."),
           figures.cpu_seconds);
  take_one(families, Families::gauge("process_start_time_seconds", "When the process started, since 1970."),
           figures.start_time);
  take_one(families, Families::gauge("process_resident_memory_bytes", "Memory in use."), figures.resident_bytes);
  take_one(families, Families::gauge("process_virtual_memory_bytes", "Addresses in use."), figures.virtual_bytes);
  take_one(families, Families::gauge("process_open_fds", "Descriptors in use."), figures.open_descriptors);
  take_one(families, Families::gauge("process_max_fds", "Descriptors that may be in use."), figures.max_descriptors);
}

}  // namespace gateway::http
