#include "daemon/http/families.h"

#include <prometheus/metric_type.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <sstream>
#include <utility>

namespace gateway::http {
namespace {

// These have the names that all of Prometheus' client libraries give them.
std::string full_name(std::string_view name) {
  return name.starts_with("process_") ? std::string(name) : "canopen_gateway_" + std::string(name);
}

// HELP and TYPE stand in front of a metric once.
std::string_view without_comments(std::string_view text) {
  while (text.starts_with('#')) {
    text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  }
  return text;
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
  if (family.family().metric.empty()) {
    return;
  }
  std::ostringstream out;
  prometheus::TextSerializer().Serialize(out, {family.family()});
  const std::string text = std::move(out).str();
  const auto found = std::ranges::find(worded_, family.family().name, &Worded::name);
  const std::string_view further = found == worded_.end() ? std::string_view(text) : without_comments(text);
  size_ += further.size();
  if (found == worded_.end()) {
    worded_.push_back({family.family().name, text});
  } else {
    found->text += further;
  }
}

std::string Families::text() const {
  std::string all;
  all.reserve(size_);
  for (const Worded& one : worded_) {
    all += one.text;
  }
  return all;
}

}  // namespace gateway::http
