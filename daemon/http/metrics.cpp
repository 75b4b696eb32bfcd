#include "daemon/http/metrics.h"

#include <chrono>

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

}  // namespace

void add_commands(Families& families, const Site& site) {
  Family outcomes = Families::counter("commands_total",
                                      "Commands that were answered, by outcome: ok, or the code of "
                                      "the answer. Refused ones are among them.");
  Family times = Families::histogram("command_confirmation_seconds",
                                     "From the arrival of a command to its confirmation; confirmed ones only.");
  for (const auto& [key, tally] : site.commands.tallies()) {
    add_tally(outcomes, times, site.plant.drive(key.first).model().name, key.second, tally);
  }
  families.take(std::move(outcomes));
  families.take(std::move(times));
}

Answer metrics(const Site& site) {
  Families families;
  add_program(families, site);
  add_buses(families, site.plant);
  add_drives(families, site.plant, canopen::Clock::now());
  add_alarms(families, site.plant);
  add_commands(families, site);
  add_servers(families, site);
  return {.type = "text/plain; version=0.0.4; charset=utf-8", .body = families.text()};
}

}  // namespace gateway::http
