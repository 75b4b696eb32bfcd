#include "daemon/http/command_tally.h"

#include <algorithm>

#include "bridges/process/answer.h"
#include "bridges/process/drive.h"
#include "bridges/process/plant_change.h"

namespace gateway::http {

void CommandTally::on_values(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) {}

void CommandTally::on_freshness(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) {}

void CommandTally::on_commanded(const process::Drive& /*drive*/, std::span<const process::SignalId> /*signals*/) {}

void CommandTally::on_command_done(const process::Drive& drive, const process::CommandRecord& record,
                                   const process::Outcome& outcome) {
  Tally& tally = tallies_[{drive.index(), record.writer.way}];
  if (outcome.has_error()) {
    ++tally.outcomes[process::answer_of(outcome.error().kind).mqtt_code];
    return;
  }
  ++tally.outcomes["ok"];
  ++tally.confirmed;
  const canopen::Duration took = canopen::Clock::now() - record.arrived;
  tally.took += took;
  const auto* const bound = std::ranges::lower_bound(kBounds, took);
  if (bound != kBounds.end()) {
    ++tally.within.at(static_cast<std::size_t>(bound - kBounds.begin()));
  }
}

void CommandTally::on_status(const process::Drive& /*drive*/) {}

void CommandTally::on_alarm(const process::Drive& /*drive*/, alarms::AlarmKind /*kind*/) {}

void CommandTally::on_bus(std::size_t /*bus*/) {}

void CommandTally::on_plant_change(const process::PlantChange& change) {
  Tallies now;
  for (std::size_t i = 0; i < change.drives.size(); ++i) {
    const auto& from = change.drives[i];
    for (auto at = tallies_.lower_bound({from.value_or(0), Way{}});
         from && at != tallies_.end() && at->first.first == *from; ++at) {
      now.emplace(std::pair(i, at->first.second), at->second);
    }
  }
  tallies_ = std::move(now);
}

}  // namespace gateway::http
