#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace bench {

/// Rates of the gateway and of the ceiling, measured in turn, so that a machine whose speed drifts spoils neither.
struct Comparison {
  std::string what;
  std::string unit;
  std::vector<double> ceiling;
  std::vector<double> gateway;
};

/// Measures both `rounds` times, in turn, after one round that is not counted.
[[nodiscard]] Comparison compare(std::string what, std::string unit, int rounds, const std::function<double()>& ceiling,
                                 const std::function<double()>& gateway);

/// `what: ceiling M, gateway M, ratio M (min..max of the pairs)`; all but the latter are medians.
void print(const Comparison& comparison);

/// Of the pairs.
[[nodiscard]] double median_ratio(const Comparison& comparison);

[[nodiscard]] double median(std::vector<double> values);

/// Seconds that passed while `work` ran.
template <class Work>
[[nodiscard]] double seconds_of(Work work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace bench
