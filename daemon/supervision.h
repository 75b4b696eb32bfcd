#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <string>

#include "bridges/process/plant.h"
#include "canopen/clock.h"

namespace gateway {

/// What the service manager hears of us (sd_notify(3)): ready, stopping, a status line with the drives online, and a
/// sign of life that only a turning loop gives, and only while `alive` says that its other threads go on. Without
/// systemd nothing is said.
class Supervision {
 public:
  Supervision(const boost::asio::any_io_executor& executor, const process::Plant& plant, std::function<bool()> alive);

  /// After the configuration; never waits for interface, listen address, broker or drives.
  void ready();
  /// Another configuration is looked at; until ready(), where it was taken or was not.
  void reloading();
  void stopping();

 private:
  void tick();

  const process::Plant& plant_;
  canopen::Timer timer_;
  canopen::Duration period_;
  std::function<bool()> alive_;
  bool watched_ = false;
  bool stopping_ = false;
  std::string told_;
};

/// `3 of 4 drives online, 1 with an alarm, 1 to be changed at standstill`
[[nodiscard]] std::string status_line(const process::Plant& plant);

}  // namespace gateway
