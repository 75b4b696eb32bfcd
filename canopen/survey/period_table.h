#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "canopen/frame.h"
#include "canopen/survey/day_extremes.h"
#include "canopen/survey/log_histogram.h"
#include "canopen/survey/moment.h"

namespace canopen {

/// How often the frames of one COB-ID came.
struct PeriodHealth {
  std::uint32_t cob_id = 0;
  LogHistogram::Percentiles period{};
  TimePoint last{};  ///< The newest frame.
  Duration worst{};  ///< Of a day, see DayExtremes; to 1 us.
};

/// The periods of every COB-ID that may have one: all but NMT, EMCY and SDO. Memory of a COB-ID is taken when it is
/// first heard, and never again. COB-IDs are taken for those of the predefined connection set: the node is in the lower
/// seven bits.
class PeriodTable {
 public:
  void hear(std::uint32_t cob_id, const Moment& moment);
  /// The node booted, was lost or changed its state: what lasts across that is no period of its frames.
  void break_node(std::uint8_t node) noexcept { ++breaks_[node & kNodeMask]; }
  /// Those that were heard twice within the day, by COB-ID.
  [[nodiscard]] std::vector<PeriodHealth> of_day(std::uint32_t hour) const;

 private:
  static constexpr std::uint32_t kNodeMask = 0x7F;
  struct Record {
    TimePoint last{};
    std::uint32_t unbroken = 0;  ///< With the breaks of its node. Both only grow.
    LogHistogram periods{};
    DayExtremes worst{};
  };
  std::array<std::unique_ptr<Record>, kMaxCobId + 1> records_{};
  std::array<std::uint32_t, kNodeMask + 1> breaks_{};
};

}  // namespace canopen
