#include "canopen/node/consumer_table.h"

#include <algorithm>

namespace canopen {
namespace {

/// How well an entry suits; 0: not at all.
int suits(Raw value, Raw wanted) noexcept {
  if (consumer_node(value) == consumer_node(wanted)) {
    return (value & kConsumerUsed) == wanted ? 4 : consumer_time(value) != 0 ? 3 : 2;
  }
  return consumer_node(value) == 0 || consumer_time(value) == 0 ? 1 : 0;
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
    if (entry.sub != best->sub && consumer_node(entry.value) == consumer_node(wanted) &&
        consumer_time(entry.value) != 0) {
      plan.push_back({entry.sub, 0});
    }
  }
  plan.push_back({best->sub, wanted});
  return plan;
}

}  // namespace canopen
