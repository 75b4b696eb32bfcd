#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "canopen/bus/link.h"
#include "config/model.h"
#include "daemon/line_reader.h"
#include "simulator/console.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "simulator/options.h"

namespace gateway {

/// Why a drive cannot be simulated.
class NotSimulated : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Simulated drives on one or more buses, with a console on standard input.
class SimulatedSite {
 public:
  /// Takes the lines that answer what came on standard input.
  using Answers = std::function<void(std::string_view text)>;

  /// `commissioning` is that of all its drives.
  explicit SimulatedSite(
      const boost::asio::any_io_executor& executor, Answers answers = [](std::string_view) {},
      const simulator::DriveOptions& commissioning = {});

  /// A bus for drives to be added to; its position.
  std::size_t add_network(std::unique_ptr<canopen::Link> link);
  /// Throws NotSimulated for a kind or node that cannot be simulated, or a node that is there already.
  void add_drive(std::size_t network, std::string_view kind, std::uint8_t node);

  /// The model's drives on one of its buses, each by the name of its profile; throws the same, with the drive's name.
  void add_drives(std::size_t network, const config::Model& model, std::size_t bus);

  /// Opens the buses, switches the drives on and reads orders from standard input.
  void start();
  void stop();

  [[nodiscard]] const std::vector<std::unique_ptr<simulator::Drive>>& drives() const noexcept { return drives_; }

 private:
  boost::asio::any_io_executor executor_;
  simulator::DriveOptions commissioning_;
  std::vector<std::unique_ptr<simulator::Network>> networks_;
  std::vector<std::unique_ptr<simulator::Drive>> drives_;
  simulator::Console console_;
  LineReader reader_;
};

}  // namespace gateway
