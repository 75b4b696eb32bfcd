#pragma once

#include <prometheus/client_metric.h>
#include <prometheus/metric_family.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gateway::http {

using Labels = std::vector<prometheus::ClientMetric::Label>;

/// One metric with the values that its labels tell apart. Nobody sees one without values.
class Family {
 public:
  Family(std::string_view name, std::string_view help, prometheus::MetricType type);

  void add(Labels labels, double value);
  void add(Labels labels, std::uint64_t value) { add(std::move(labels), static_cast<double>(value)); }
  void add(Labels labels, bool value) { add(std::move(labels), value ? 1.0 : 0.0); }
  void add(Labels labels, prometheus::ClientMetric::Histogram histogram);
  [[nodiscard]] prometheus::MetricFamily& family() noexcept { return family_; }

 private:
  prometheus::MetricFamily family_;
};

/// All that /metrics tells. Each name begins with `canopen_gateway_`, but for those that every process has.
class Families {
 public:
  [[nodiscard]] static Family counter(std::string_view name, std::string_view help);
  [[nodiscard]] static Family gauge(std::string_view name, std::string_view help);
  [[nodiscard]] static Family histogram(std::string_view name, std::string_view help);

  /// What was taken of this metric before stays.
  void take(Family family);
  /// Prometheus' text format, version 0.0.4.
  [[nodiscard]] std::string text() const;
  /// Its length.
  [[nodiscard]] std::size_t size() const noexcept { return size_; }

 private:
  struct Worded {
    std::string name;
    std::string text;
  };

  std::vector<Worded> worded_;
  std::size_t size_ = 0;
};

}  // namespace gateway::http
