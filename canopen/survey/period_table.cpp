#include "canopen/survey/period_table.h"

#include <algorithm>
#include <optional>

#include "canopen/cob_id.h"

namespace canopen {
namespace {

constexpr std::uint32_t kFirstAfterEmcy = 0x100;
constexpr std::uint32_t kFirstSdo = 0x581;
constexpr std::uint32_t kLastSdo = 0x67F;

bool may_have_a_period(std::uint32_t cob_id) noexcept {
  const bool emcy = cob_id > kEmcyBase && cob_id < kFirstAfterEmcy;
  const bool sdo = cob_id >= kFirstSdo && cob_id <= kLastSdo;
  return cob_id != kNmtCobId && !emcy && !sdo && cob_id <= kMaxCobId;
}

}  // namespace

void PeriodTable::hear(std::uint32_t cob_id, const Moment& moment) {
  if (!may_have_a_period(cob_id)) {
    return;
  }
  std::unique_ptr<Record>& record = records_[cob_id];
  const std::uint32_t unbroken = moment.unbroken + breaks_[cob_id & kNodeMask];
  if (!record) {
    record = std::make_unique<Record>();
  } else if (record->unbroken == unbroken) {
    const Duration period = moment.at - record->last;
    record->periods.add(period);
    record->worst.add(to_units(period), moment.hour);
  }
  record->last = moment.at;
  record->unbroken = unbroken;
}

std::vector<PeriodHealth> PeriodTable::of_day(std::uint32_t hour) const {
  std::vector<PeriodHealth> periods;
  for (std::uint32_t cob_id = 0; cob_id < records_.size(); ++cob_id) {
    const std::unique_ptr<Record>& record = records_[cob_id];
    const std::optional<Extremes> day = record ? record->worst.of_day(hour) : std::nullopt;
    if (day) {
      PeriodHealth health{.cob_id = cob_id,
                          .period = record->periods.percentiles(),
                          .last = record->last,
                          .worst = from_units(day->most)};
      // A step of the histogram may reach beyond what there was.
      health.period.p50 = std::min(health.period.p50, health.worst);
      health.period.p99 = std::min(health.period.p99, health.worst);
      periods.push_back(health);
    }
  }
  return periods;
}

}  // namespace canopen
