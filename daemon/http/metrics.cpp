#include "daemon/http/metrics.h"

#include <chrono>
#include <cstddef>
#include <utility>

namespace gateway::http {
namespace {

void add_tally(Family& outcomes, Family& times, const std::string& drive, CommandTally::Way way,
               const CommandTally::Tally& tally) {
  const std::string writer(name_of(way));
  for (const auto& [outcome, count] : tally.outcomes) {
    outcomes.add({{"drive", drive}, {"writer", writer}, {"outcome", std::string(outcome)}}, count);
  }
  if (tally.confirmed == 0) {
    return;
  }
  prometheus::ClientMetric::Histogram histogram;
  histogram.sample_count = tally.confirmed;
  histogram.sample_sum = std::chrono::duration<double>(tally.took).count();
  std::uint64_t within = 0;
  for (std::size_t i = 0; i < CommandTally::kBounds.size(); ++i) {
    within += tally.within.at(i);
    histogram.bucket.push_back({.cumulative_count = within,
                                .upper_bound = std::chrono::duration<double>(CommandTally::kBounds.at(i)).count()});
  }
  times.add({{"drive", drive}, {"writer", writer}}, std::move(histogram));
}

// The gateway, then a drive a piece: what one drive has is of one moment.
bool add_piece(Families& families, const Site& site, std::size_t piece) {
  if (piece == 0) {
    add_program(families, site);
    add_buses(families, site.plant);
    add_bus_health(families, site);
    add_alarm_counts(families, site.plant);
    add_servers(families, site);
  } else if (piece <= site.plant.size()) {  // The configuration may have changed since the last piece.
    const process::Drive& drive = site.plant.drive(piece - 1);
    add_drive(families, site.plant, drive, canopen::Clock::now());
    add_drive_health(families, site, drive);
    add_alarms(families, drive);
    add_commands(families, site, drive);
  }
  return piece < site.plant.size();
}

}  // namespace

void add_commands(Families& families, const Site& site, const process::Drive& drive) {
  Family outcomes = Families::counter("commands_total",
                                      "Commands that were answered, by outcome: ok, or the code of "
                                      "the answer. Refused ones are among them.");
  Family times = Families::histogram("command_confirmation_seconds",
                                     "From the arrival of a command to its confirmation; confirmed ones only.");
  const CommandTally::Tallies& tallies = site.commands.tallies();
  for (auto at = tallies.lower_bound({drive.index(), CommandTally::Way{}});
       at != tallies.end() && at->first.first == drive.index(); ++at) {
    add_tally(outcomes, times, drive.model().name, at->first.second, at->second);
  }
  families.take(std::move(outcomes));
  families.take(std::move(times));
}

Answer metrics(const Site& site) {
  Answer answer{.type = "text/plain; version=0.0.4; charset=utf-8"};
  answer.rest = [&site, families = Families(), piece = std::size_t{0},
                 configuration = site.plant.changes()](std::string& text) mutable {
    // What is collected has other positions then: a drive would be there twice.
    if (configuration != site.plant.changes()) {
      configuration = site.plant.changes();
      families = Families();
      piece = 0;
    }
    if (add_piece(families, site, piece++)) {
      return Progress{.goes_on = true, .kept = families.size()};
    }
    text += families.text();
    return Progress{};
  };
  return answer;
}

}  // namespace gateway::http
