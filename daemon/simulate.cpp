#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <exception>
#include <iostream>

#include "canopen/socketcan_link.h"
#include "daemon/commands.h"
#include "daemon/simulated_site.h"
#include "daemon/stop_signal.h"

namespace gateway {
namespace {

void fill_from_model(SimulatedSite& site, const config::Model& model, const boost::asio::any_io_executor& executor) {
  for (std::size_t bus = 0; bus < model.buses.size(); ++bus) {
    const std::size_t network = site.add_network(canopen::make_socketcan_link(executor, model.buses[bus].interface));
    for (const config::Drive& drive : model.drives) {
      if (drive.bus == bus) {
        site.add_drive(network, drive.profile, drive.node.node);
      }
    }
  }
}

}  // namespace

int simulate(const Options& options, const std::string& interface, const std::vector<SimulatedDrive>& drives) {
  boost::asio::io_context loop(1);
  SimulatedSite site(loop.get_executor());
  if (interface.empty()) {
    const std::optional<config::Model> model = load_or_complain(options);
    if (!model) {
      return kConfigurationError;
    }
    fill_from_model(site, *model, loop.get_executor());
  } else {
    const std::size_t network = site.add_network(canopen::make_socketcan_link(loop.get_executor(), interface));
    for (const SimulatedDrive& drive : drives) {
      site.add_drive(network, drive.kind, drive.node);
    }
  }
  site.start();
  std::cout << site.drives().size() << " drives simulated; type help for what they can be made to do" << std::endl;
  boost::asio::co_spawn(loop, stop_signal(loop.get_executor()), [&](const std::exception_ptr& error) {
    if (error) {
      std::rethrow_exception(error);
    }
    site.stop();
    loop.stop();
  });
  loop.run();
  return kDone;
}

}  // namespace gateway
