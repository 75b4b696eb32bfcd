#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopen/frame.h"
#include "canopen/survey/day_extremes.h"
#include "canopen/survey/log_histogram.h"
#include "canopen/survey/moment.h"

namespace canopen {

/// By node id; 0 is none.
using NodeSet = std::bitset<128>;

/// What is heard of one node.
struct NodeHealth {
  std::uint8_t node = 0;
  Duration timeout{};  ///< Silence that means loss; zero: nobody waits for it.
  /// Between two of its heartbeats, or answers to guarding, while it was served; of a day, to 1 us.
  std::optional<Duration> shortest_gap{};
  std::optional<Duration> longest_gap{};
  /// From a request of ours to the first answer. Segments and block transfers count each by itself.
  LogHistogram::Percentiles answers{};

  /// What was left of the time-out in the longest gap: 1 would be all of it, 0 is loss. Nothing without a gap or a
  /// time-out.
  [[nodiscard]] std::optional<double> worst_margin() const noexcept { return margin(longest_gap); }
  [[nodiscard]] std::optional<double> best_margin() const noexcept { return margin(shortest_gap); }

 private:
  [[nodiscard]] std::optional<double> margin(const std::optional<Duration>& gap) const noexcept;
};

/// Heartbeats and SDO answers of each node.
class NodeTable {
 public:
  void set_timeout(std::uint8_t node, Duration timeout) { nodes_.at(node).timeout = timeout; }
  /// Those that are online: of the others a gap is no sign.
  void set_served(const NodeSet& served) noexcept { served_ = served; }

  /// COB-ID 0x700 + node. A boot-up ends the node's life and no gap. True: it booted, or is in another state than
  /// before.
  bool hear_error_control(std::uint8_t node, const Frame& frame, const Moment& moment) noexcept;
  void hear_request(std::uint8_t node, const Frame& frame, bool ours, const Moment& moment) noexcept;
  void hear_answer(std::uint8_t node, const Moment& moment) noexcept;

  /// Those of which a time-out is known, or that answered; in the order of their ids.
  [[nodiscard]] std::vector<NodeHealth> of_day(std::uint32_t hour) const;
  [[nodiscard]] NodeHealth of_day(std::uint8_t node, std::uint32_t hour) const;

 private:
  struct Record {
    Duration timeout{};
    TimePoint last{};            ///< Of its heartbeats.
    std::uint32_t unbroken = 0;  ///< Of the last one.
    bool gap_counts = false;     ///< It was served then.
    std::uint8_t state = 0;      ///< That the last one told; 0: it booted.
    bool asked = false;          ///< A request of ours waits for its answer.
    std::uint32_t asked_unbroken = 0;
    TimePoint asked_at{};
    DayExtremes gaps{};
    LogHistogram answers{};
  };
  std::vector<Record> nodes_ = std::vector<Record>(NodeSet().size());
  NodeSet served_;
};

}  // namespace canopen
