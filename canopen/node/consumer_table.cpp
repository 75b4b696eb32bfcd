#include "canopen/node/consumer_table.h"

#include <algorithm>

namespace canopen {
namespace {

constexpr Raw kUsed = 0x00FF'FFFF;  // Bits 24..31 are reserved.

Raw node_of(Raw value) noexcept {
  return (value >> 16U) & 0xFFU;
}

Raw time_of(Raw value) noexcept {
  return value & 0xFFFFU;
}

/// How well an entry suits; 0: not at all.
int suits(Raw value, Raw wanted) noexcept {
  if (node_of(value) == node_of(wanted)) {
    return (value & kUsed) == wanted ? 4 : time_of(value) != 0 ? 3 : 2;
  }
  return node_of(value) == 0 || time_of(value) == 0 ? 1 : 0;
}

}  // namespace

std::optional<std::vector<ConsumerEntry>> plan_consumer_table(std::span<const ConsumerEntry> found, Raw wanted) {
  const auto best = std::max_element(found.begin(), found.end(), [wanted](const auto& a, const auto& b) {
    return suits(a.value, wanted) < suits(b.value, wanted);
  });
  if (best == found.end() || suits(best->value, wanted) == 0) {
    return std::nullopt;
  }
  std::vector<ConsumerEntry> plan;
  for (const ConsumerEntry& entry : found) {
    if (entry.sub != best->sub && node_of(entry.value) == node_of(wanted) && time_of(entry.value) != 0) {
      plan.push_back({entry.sub, 0});
    }
  }
  plan.push_back({best->sub, wanted});
  return plan;
}

}  // namespace canopen
