#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <optional>

#include "bridges/alarms/drive_alarms.h"
#include "bridges/process/image.h"
#include "canopen/clock.h"
#include "canopen/node/node_events.h"
#include "canopen/wake_up.h"
#include "config/model.h"

namespace canopen {
class RemoteNode;
}

namespace process {

/// When a drive's alarms that nothing has told of count as not active, after the gateway's start.
class Settling {
 public:
  /// All outlive it.
  Settling(const boost::asio::any_io_executor& executor, const config::Drive& model, const canopen::RemoteNode& node,
           const Image& image, alarms::DriveAlarms& alarms);

  void start();
  void stop() { patience_.cancel(); }
  void on_status(const canopen::NodeStatus& status);
  /// Called for each frame; costs nothing once it was decided.
  void on_values(SourceId source);

 private:
  void on_patience_over();

  const config::Drive& model_;
  const canopen::RemoteNode& node_;
  const Image& image_;
  alarms::DriveAlarms& alarms_;
  canopen::WakeUp patience_;
  std::optional<std::uint32_t> boot_ups_;  ///< When the patience ended beside a boot.
  std::optional<canopen::TimePoint> operational_since_;
  bool settled_ = false;
};

}  // namespace process
