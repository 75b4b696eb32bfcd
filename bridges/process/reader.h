#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <optional>

#include "bridges/alarms/drive_alarms.h"
#include "bridges/alarms/register_watch.h"
#include "bridges/process/inputs.h"
#include "canopen/clock.h"
#include "canopen/event.h"
#include "config/model.h"

namespace canopen {
class RemoteNode;
}

namespace process {

/// Reads by SDO what a drive does not send, one object at a time: its errors after its arrival and while one is
/// undecided, then what its inputs ask for.
class Reader {
 public:
  /// All arguments outlive it.
  Reader(boost::asio::any_io_executor executor, const config::Drive& model, canopen::RemoteNode& node, Inputs& inputs,
         alarms::DriveAlarms& alarms);

  void start();
  /// To be called when the node was stopped, so that nothing is under way for long.
  boost::asio::awaitable<void> stop();

  /// The inputs ask for something earlier than before.
  void wake() { changed_.notify(); }
  /// The drive's errors are to be looked at.
  void check_errors();
  /// The drive went away.
  void forget_errors();
  void on_emergency(canopen::TimePoint at) { watch_.on_emergency(at); }
  /// Which errors are undecided may have changed: as long as any is, 0x1001 is read. Cheap where nothing changed.
  void watch_errors();

 private:
  boost::asio::awaitable<void> run();
  boost::asio::awaitable<void> read_errors();
  boost::asio::awaitable<void> read_error_register();
  [[nodiscard]] canopen::TimePoint watch_at() const { return watch_.next(undecided_since_); }
  boost::asio::awaitable<void> read(ReadJob job);

  boost::asio::any_io_executor executor_;
  const config::Drive& model_;
  canopen::RemoteNode& node_;
  Inputs& inputs_;
  alarms::DriveAlarms& alarms_;
  canopen::Event changed_;
  canopen::TimePoint check_at_ = canopen::TimePoint::max();
  canopen::TimePoint not_before_ = canopen::TimePoint::min();  ///< Of the next check for errors.
  alarms::RegisterWatch watch_;
  std::optional<canopen::TimePoint> undecided_since_;
  bool running_ = false;
  bool stopping_ = false;
};

}  // namespace process
