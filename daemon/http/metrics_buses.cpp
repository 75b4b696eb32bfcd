#include <algorithm>
#include <array>
#include <utility>

#include "bridges/alarms/reason.h"
#include "canopen/bus/error_share.h"
#include "daemon/http/metrics.h"

namespace gateway::http {
namespace {

using canopen::BusCondition;
using canopen::BusState;
using canopen::BusStatistics;

constexpr std::array kConditions{BusCondition::error_active, BusCondition::warning, BusCondition::passive,
                                 BusCondition::bus_off, BusCondition::down};

// As in /health.
std::string state_word(BusCondition condition) {
  return condition == BusCondition::error_active ? "active" : std::string(alarms::bus_reason(condition));
}

/// The metrics of buses, of which each is told what one bus has.
struct BusFamilies {
  Family received = Families::counter("bus_frames_received_total", "Frames received.");
  Family sent = Families::counter("bus_frames_sent_total", "Frames sent: their own echo came back.");
  Family lost = Families::counter("bus_frames_lost_total", "Frames that the system lost before the gateway read them.");
  Family offs = Families::counter("bus_off_events_total", "How often the controller went bus-off.");
  Family load =
      Families::gauge("bus_load_ratio", "Load of the last second, 0 to 1; missing where no bit rate is known.");
  Family highest = Families::gauge("bus_highest_load_ratio", "The highest load of any second since the start.");
  Family errors = Families::gauge("bus_error_frames_ratio", "Error frames among the last 10000 frames, 0 to 1.");
  Family transmit = Families::gauge("bus_transmit_errors", "The controller's transmit error counter.");
  Family receive = Families::gauge("bus_receive_errors", "The controller's receive error counter.");
  Family up = Families::gauge("bus_up", "1: frames can be exchanged.");
  Family state = Families::gauge("bus_state", "1 for the state that the bus has, 0 for the others.");

  void add(const std::string& name, const BusState& bus, const BusStatistics& counted);
};

void BusFamilies::add(const std::string& name, const BusState& bus, const BusStatistics& counted) {
  const Labels labels{{"bus", name}};
  received.add(labels, counted.frames_received);
  sent.add(labels, counted.frames_sent);
  lost.add(labels, std::uint64_t{counted.frames_lost});
  offs.add(labels, std::uint64_t{counted.bus_offs});
  if (counted.bitrate != 0) {
    load.add(labels, counted.load_per_mille / 1000.0);
    highest.add(labels, counted.highest_load_per_mille / 1000.0);
  }
  errors.add(labels, error_share(counted));
  transmit.add(labels, std::uint64_t{bus.transmit_errors});
  receive.add(labels, std::uint64_t{bus.receive_errors});
  up.add(labels, bus.up());
  for (const BusCondition condition : kConditions) {
    state.add({{"bus", name}, {"state", state_word(condition)}}, condition == bus.condition);
  }
}

}  // namespace

double error_share(const BusStatistics& counted) {
  const std::uint64_t seen = counted.frames_received + counted.frames_sent + counted.error_frames;
  const std::uint64_t among = std::clamp<std::uint64_t>(seen, 1, canopen::ErrorShare::kWindow);
  return counted.error_frames / static_cast<double>(among);
}

void add_buses(Families& families, const process::Plant& plant) {
  BusFamilies buses;
  for (std::size_t i = 0; i < plant.model().buses.size(); ++i) {
    buses.add(plant.model().buses[i].name, plant.bus_state(i), plant.bus_statistics(i));
  }
  for (Family* const family : {&buses.received, &buses.sent, &buses.lost, &buses.offs, &buses.load, &buses.highest,
                               &buses.errors, &buses.transmit, &buses.receive, &buses.up, &buses.state}) {
    families.take(std::move(*family));
  }
}

}  // namespace gateway::http
