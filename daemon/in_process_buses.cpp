#include "daemon/in_process_buses.h"

namespace gateway {

InProcessBuses::InProcessBuses(const boost::asio::any_io_executor& executor, const config::Model& model)
    : model_(model) {
  for (std::size_t i = 0; i < model.buses.size(); ++i) {
    buses_.push_back(std::make_unique<canopen::VirtualBus>(executor));
  }
}

std::unique_ptr<canopen::Link> InProcessBuses::connect(const config::Bus& bus) {
  return connect(static_cast<std::size_t>(&bus - model_.buses.data()));
}

void InProcessBuses::add_drives(SimulatedSite& site) {
  for (std::size_t bus = 0; bus < model_.buses.size(); ++bus) {
    site.add_drives(site.add_network(connect(bus)), model_, bus);
  }
}

}  // namespace gateway
