#include <fmt/format.h>
#include <unistd.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <exception>
#include <iostream>

#include "canopen/bus/socketcan/socketcan_link.h"
#include "daemon/announced_link.h"
#include "daemon/commands.h"
#include "daemon/descriptors.h"
#include "daemon/output.h"
#include "daemon/simulated_site.h"
#include "daemon/stop_signal.h"

namespace gateway {
namespace {

std::size_t add_interface(SimulatedSite& site, const std::string& interface,
                          const boost::asio::any_io_executor& executor) {
  if (interface == config::kVirtualInterface) {
    throw NotSimulated(
        "a virtual bus is inside of one process, nothing else can be on it; name a SocketCAN interface, or use `demo`");
  }
  auto link = canopen::make_socketcan_link(executor, interface,
                                           [](const std::string& text) { std::cerr << text << std::endl; });
  return site.add_network(make_announced_link(std::move(link), interface, std::cerr));
}

void add_drives(SimulatedSite& site, const std::string& interface, const std::vector<SimulatedDrive>& drives,
                const boost::asio::any_io_executor& executor) {
  const std::size_t network = add_interface(site, interface, executor);
  for (const SimulatedDrive& drive : drives) {
    site.add_drive(network, drive.kind, drive.node);
  }
}

void add_drives(SimulatedSite& site, const config::Model& model, const boost::asio::any_io_executor& executor) {
  for (std::size_t bus = 0; bus < model.buses.size(); ++bus) {
    const std::size_t network = add_interface(site, model.buses[bus].interface, executor);
    site.add_drives(network, model, bus);
  }
}

}  // namespace

int simulate(const Options& options, const Simulation& simulation) {
  boost::asio::io_context loop(1);
  StopSignal stop(loop.get_executor());
  LiveOutput output(STDOUT_FILENO, [&stop] { stop.stop(); });
  simulator::DriveOptions commissioning;
  commissioning.tpdo_event_ms = simulation.tpdo_event_ms;
  SimulatedSite site(loop.get_executor(), [&output](std::string_view text) { output.write(text); }, commissioning);
  const bool by_configuration = simulation.interface.empty();
  try {
    if (!by_configuration) {
      add_drives(site, simulation.interface, simulation.drives, loop.get_executor());
    } else if (const std::optional<config::Model> model = load_or_complain(options, Secrets::leave)) {
      add_drives(site, *model, loop.get_executor());
    } else {
      return kConfigurationError;
    }
  } catch (const NotSimulated& reason) {
    complain(reason.what());
    return by_configuration ? kConfigurationError : kUsage;
  }
  site.start();
  const bool one = site.drives().size() == 1;
  output.write(fmt::format("{} {} simulated; type help for what can be done to {}\n", site.drives().size(),
                           one ? "drive" : "drives", one ? "it" : "them"));
  boost::asio::co_spawn(loop, stop.wait(), [&](const std::exception_ptr& error) {
    if (error) {
      std::rethrow_exception(error);
    }
    site.stop();
    loop.stop();
  });
  loop.run();
  output.require_written();
  return kDone;
}

}  // namespace gateway
