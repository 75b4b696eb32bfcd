#include "canopen/survey/node_table.h"

#include <algorithm>

namespace canopen {
namespace {

constexpr std::uint8_t kToldStateMask = 0x7F;  // Beside the toggle bit of guarding.
constexpr std::uint8_t kSdoAbort = 0x80;       // A segment of a block has a number beside that bit.

}  // namespace

std::optional<double> NodeHealth::margin(const std::optional<Duration>& gap) const noexcept {
  if (!gap || timeout <= Duration::zero()) {
    return std::nullopt;
  }
  const double used = static_cast<double>(gap->count()) / static_cast<double>(timeout.count());
  return std::max(0.0, 1.0 - used);
}

bool NodeTable::hear_error_control(std::uint8_t node, const Frame& frame, const Moment& moment) noexcept {
  Record& record = nodes_[node];
  const bool boot_up = frame.size > 0 && frame.data[0] == 0;
  const auto state = static_cast<std::uint8_t>(frame.data[0] & kToldStateMask);
  const bool changed = boot_up || state != record.state;
  if (record.gap_counts && !boot_up && record.unbroken == moment.unbroken) {
    record.gaps.add(to_units(moment.at - record.last), moment.hour);
  }
  record.last = moment.at;
  record.unbroken = moment.unbroken;
  record.gap_counts = !boot_up && served_[node];
  record.state = state;
  return changed;
}

void NodeTable::hear_request(std::uint8_t node, const Frame& frame, bool ours, const Moment& moment) noexcept {
  Record& record = nodes_[node];
  // Of another client's request nobody can tell whose answer comes.
  record.asked = ours && frame.data[0] != kSdoAbort;
  record.asked_at = moment.at;
  record.asked_unbroken = moment.unbroken;
}

void NodeTable::hear_answer(std::uint8_t node, const Moment& moment) noexcept {
  Record& record = nodes_[node];
  if (record.asked && record.asked_unbroken == moment.unbroken) {
    record.answers.add(moment.at - record.asked_at);
  }
  record.asked = false;
}

NodeHealth NodeTable::of_day(std::uint8_t node, std::uint32_t hour) const {
  const Record& record = nodes_.at(node);
  NodeHealth health{.node = node, .timeout = record.timeout, .answers = record.answers.percentiles()};
  if (const std::optional<Extremes> gaps = record.gaps.of_day(hour)) {
    health.shortest_gap = from_units(gaps->least);
    health.longest_gap = from_units(gaps->most);
  }
  return health;
}

std::vector<NodeHealth> NodeTable::of_day(std::uint32_t hour) const {
  std::vector<NodeHealth> all;
  for (std::size_t node = 1; node < nodes_.size(); ++node) {
    const NodeHealth health = of_day(static_cast<std::uint8_t>(node), hour);
    if (health.timeout > Duration::zero() || health.longest_gap || health.answers.count > 0) {
      all.push_back(health);
    }
  }
  return all;
}

}  // namespace canopen
