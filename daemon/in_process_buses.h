#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <memory>
#include <vector>

#include "canopen/bus/virtual_link.h"
#include "config/model.h"
#include "daemon/simulated_site.h"

namespace gateway {

/// The buses of a site inside of this process, whatever interfaces its configuration names.
class InProcessBuses {
 public:
  /// `model` outlives it.
  InProcessBuses(const boost::asio::any_io_executor& executor, const config::Model& model);

  [[nodiscard]] std::unique_ptr<canopen::Link> connect(std::size_t bus) { return buses_.at(bus)->connect(); }
  /// `bus`: one of the model's.
  [[nodiscard]] std::unique_ptr<canopen::Link> connect(const config::Bus& bus);
  /// Every drive of the model, simulated. @throws NotSimulated
  void add_drives(SimulatedSite& site);

 private:
  const config::Model& model_;
  std::vector<std::unique_ptr<canopen::VirtualBus>> buses_;
};

}  // namespace gateway
