#include "tests/bench/rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace bench {
namespace {

std::vector<double> ratios_of(const Comparison& comparison) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < comparison.ceiling.size(); ++i) {
    ratios.push_back(comparison.gateway[i] / comparison.ceiling[i]);
  }
  return ratios;
}

}  // namespace

Comparison compare(std::string what, std::string unit, int rounds, const std::function<double()>& ceiling,
                   const std::function<double()>& gateway) {
  Comparison result{std::move(what), std::move(unit), {}, {}};
  for (int round = 0; round <= rounds; ++round) {
    const double above = ceiling();
    const double reached = gateway();
    if (round > 0) {
      result.ceiling.push_back(above);
      result.gateway.push_back(reached);
    }
  }
  return result;
}

double median_ratio(const Comparison& comparison) {
  return median(ratios_of(comparison));
}

double median(std::vector<double> values) {
  if (values.empty()) {
    return 0;
  }
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

void print(const Comparison& comparison) {
  const std::vector<double> ratios = ratios_of(comparison);
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  fmt::print("{:<44} ceiling {:>10.0f} {}, gateway {:>10.0f} {}, ratio {:.2f} ({:.2f}..{:.2f})\n", comparison.what,
             median(comparison.ceiling), comparison.unit, median(comparison.gateway), comparison.unit, median(ratios),
             *least, *most);
  std::fflush(stdout);
}

}  // namespace bench
