#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "bridges/process/plant.h"
#include "canopen/clock.h"
#include "config/drive_notes.h"

namespace gateway {

/// What the demo shows: first what to try, then the drives as the gateway sees them, again and again.
class DemoScreen {
 public:
  using Output = std::function<void(std::string_view text)>;

  /// `guide` comes first. `often`: for a terminal, every other second; else every ten.
  DemoScreen(const boost::asio::any_io_executor& executor, const process::Plant& plant, std::string guide, Output out,
             bool often);

  void start();
  void stop();

 private:
  void show();

  const process::Plant& plant_;
  std::string guide_;
  Output out_;
  canopen::Timer timer_;
  canopen::Duration period_;
};

/// The page's address, and commands for another terminal, made from the model's own addresses and topics. `notes` are
/// those of its drives.
[[nodiscard]] std::string demo_guide(const config::Model& model, std::span<const config::DriveNotes> notes);
/// One line for each drive.
[[nodiscard]] std::string demo_table(const process::Plant& plant, canopen::TimePoint now);

}  // namespace gateway
