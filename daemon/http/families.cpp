#include "daemon/http/families.h"

#include <prometheus/metric_type.h>
#include <prometheus/text_serializer.h>

#include <sstream>
#include <utility>

namespace gateway::http {
namespace {

// These have the names that all of Prometheus' client libraries give them.
std::string full_name(std::string_view name) {
  return name.starts_with("process_") ? std::string(name) : "canopen_gateway_" + std::string(name);
}

}  // namespace

Family::Family(std::string_view name, std::string_view help, prometheus::MetricType type)
    : family_{.name = full_name(name), .help = std::string(help), .type = type, .metric = {}} {}

void Family::add(Labels labels, double value) {
  prometheus::ClientMetric metric;
  metric.label = std::move(labels);
  (family_.type == prometheus::MetricType::Counter ? metric.counter.value : metric.gauge.value) = value;
  family_.metric.push_back(std::move(metric));
}

void Family::add(Labels labels, prometheus::ClientMetric::Histogram histogram) {
  prometheus::ClientMetric metric;
  metric.label = std::move(labels);
  metric.histogram = std::move(histogram);
  family_.metric.push_back(std::move(metric));
}

Family Families::counter(std::string_view name, std::string_view help) {
  return {name, help, prometheus::MetricType::Counter};
}

Family Families::gauge(std::string_view name, std::string_view help) {
  return {name, help, prometheus::MetricType::Gauge};
}

Family Families::histogram(std::string_view name, std::string_view help) {
  return {name, help, prometheus::MetricType::Histogram};
}

void Families::take(Family family) {
  if (!family.family().metric.empty()) {
    families_.push_back(std::move(family.family()));
  }
}

std::string Families::text() const {
  std::ostringstream out;
  prometheus::TextSerializer().Serialize(out, families_);
  return std::move(out).str();
}

}  // namespace gateway::http
