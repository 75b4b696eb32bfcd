#include "daemon/surveys.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <optional>
#include <string>
#include <utility>

#include "bridges/process/plant.h"
#include "canopen/bus/bus.h"
#include "canopen/survey/bus_survey.h"

namespace gateway {
namespace {

using canopen::BusSurvey;

BusSurvey::Known known_of(const process::Plant& plant, std::size_t bus, const canopen::BusTroubles& troubles) {
  BusSurvey::Known known{.troubles = troubles};
  canopen::Doubled surest = canopen::Doubled::no;
  for (std::size_t i = 0; i < plant.size(); ++i) {
    const process::Drive& drive = plant.drive(i);
    if (drive.bus() != bus) {
      continue;
    }
    const canopen::NodeStatus& status = drive.status();
    const std::uint8_t node = drive.model().node.node;
    known.served.set(node, status.online);
    if (status.doubled > surest) {
      surest = status.doubled;
      known.doubled = canopen::DoubledSign{.node = node, .text = status.doubled_text};
    }
  }
  return known;
}

}  // namespace

std::unique_ptr<BusSurvey> make_survey(const boost::asio::any_io_executor& executor, canopen::Bus& bus,
                                       const process::Plant& plant, const SurveyedBus& known) {
  const std::string name = plant.model().buses[known.index].name;
  auto survey = std::make_unique<BusSurvey>(
      executor, bus,
      BusSurvey::Handlers{
          .known = [&plant, &known] { return known_of(plant, known.index, known.troubles); },
          .began =
              [name](const canopen::Suspicion& began, const std::optional<canopen::Suspicion>& displaced) {
                spdlog::warn("{}: suspicion: {}{}", name, began.text(),
                             displaced ? fmt::format(" (before: {})", describe(displaced->kind)) : "");
              },
          .ended =
              [name](const canopen::Suspicion& ended) {
                spdlog::info("{}: no longer suspected: {}", name, describe(ended.kind));
              }});
  set_timeouts(*survey, plant, known.index);
  return survey;
}

void set_timeouts(BusSurvey& survey, const process::Plant& plant, std::size_t bus) {
  constexpr std::uint8_t kLastNode = 127;
  for (std::uint8_t node = 1; node <= kLastNode; ++node) {
    survey.set_timeout(node, {});  // Of no drive, until one is found.
  }
  for (const config::Drive& drive : plant.model().drives) {
    if (drive.bus == bus && drive.enabled) {
      survey.set_timeout(drive.node.node, drive.node.error_control.heartbeat_timeout);
    }
  }
}

}  // namespace gateway
