#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "canopen/survey/bus_survey.h"
#include "daemon/http/metrics.h"

namespace gateway::http {
namespace {

double seconds_of(canopen::Duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

void add_bus_health(Families& families, const Site& site) {
  if (!site.survey) {
    return;
  }
  Family burst = Families::gauge("bus_longest_burst_frames",
                                 "Most frames of the last day that came without a pause; missing where no bit rate is "
                                 "known.");
  Family suspicion = Families::gauge("bus_suspicion", "1: this is suspected of the bus; see /api/buses for the words.");
  for (std::size_t bus = 0; bus < site.plant.model().buses.size(); ++bus) {
    const std::string& name = site.plant.model().buses[bus].name;
    const canopen::BusSurvey& survey = site.survey(bus);
    if (const std::optional<canopen::Burst> longest = survey.burst()) {
      burst.add({{"bus", name}}, std::uint64_t{longest->frames});
    }
    const std::optional<canopen::Suspicion>& suspected = survey.suspicion();
    for (const canopen::SuspicionKind kind : canopen::kSuspicionKinds) {
      suspicion.add({{"bus", name}, {"kind", std::string(name_of(kind))}}, suspected && suspected->kind == kind);
    }
  }
  families.take(std::move(burst));
  families.take(std::move(suspicion));
}

void add_drive_health(Families& families, const Site& site, const process::Drive& drive) {
  if (!site.survey) {
    return;
  }
  Family margin = Families::gauge("drive_heartbeat_margin_ratio",
                                  "What the longest gap of the last day left of the heartbeat time-out, 0 to 1.");
  Family answers = Families::gauge("drive_sdo_answer_seconds", "Time to an SDO answer, of the newest some thousand.");
  const std::string& name = drive.model().name;
  const canopen::NodeHealth node = site.survey(drive.bus()).node(drive.model().node.node);
  if (const std::optional<double> worst = node.worst_margin()) {
    margin.add({{"drive", name}}, *worst);
  }
  if (node.answers.count > 0) {
    answers.add({{"drive", name}, {"percentile", "50"}}, seconds_of(node.answers.p50));
    answers.add({{"drive", name}, {"percentile", "99"}}, seconds_of(node.answers.p99));
  }
  families.take(std::move(margin));
  families.take(std::move(answers));
}

}  // namespace gateway::http
