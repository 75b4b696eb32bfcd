#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/link.h"
#include "daemon/line_reader.h"
#include "simulator/console.h"
#include "simulator/drive.h"
#include "simulator/network.h"

namespace gateway {

/// Simulated drives on one or more buses, with a console on standard input.
class SimulatedSite {
 public:
  explicit SimulatedSite(const boost::asio::any_io_executor& executor);

  /// A bus for drives to be added to; its position.
  std::size_t add_network(std::unique_ptr<canopen::Link> link);
  /// Throws std::runtime_error for a kind or node that cannot be simulated, or a node that is there already.
  void add_drive(std::size_t network, std::string_view kind, std::uint8_t node);

  /// Opens the buses, switches the drives on and reads orders from standard input.
  void start();
  void stop();

  [[nodiscard]] const std::vector<std::unique_ptr<simulator::Drive>>& drives() const noexcept { return drives_; }

 private:
  boost::asio::any_io_executor executor_;
  std::vector<std::unique_ptr<simulator::Network>> networks_;
  std::vector<std::unique_ptr<simulator::Drive>> drives_;
  simulator::Console console_;
  LineReader reader_;
};

}  // namespace gateway
