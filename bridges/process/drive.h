#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <memory>
#include <vector>

#include "bridges/process/alarm.h"
#include "bridges/process/command.h"
#include "bridges/process/image.h"
#include "bridges/process/observer.h"
#include "bridges/process/writer.h"
#include "canopen/error.h"
#include "canopen/nmt.h"
#include "canopen/node/node_events.h"
#include "config/model.h"

namespace canopen {
class Bus;
}

namespace process {

/// One drive as the bridges see it: its model, its image, its alarms, its status, and the one way for commands.
class Drive {
 public:
  /// `model`, `bus` and `observers` outlive the drive; `observers` may grow until start().
  Drive(boost::asio::any_io_executor executor, const config::Drive& model, std::size_t index, canopen::Bus& bus,
        const std::vector<Observer*>& observers);
  ~Drive();
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  void start();
  /// The end is near: commands that have not begun, and all that come from now on, are answered `offline`; a drive that
  /// is not in service is neither configured nor started any more.
  void close();
  /// Pending commands are answered `offline`. Sends nothing to the drive.
  boost::asio::awaitable<void> stop();

  [[nodiscard]] const config::Drive& model() const noexcept;
  [[nodiscard]] std::size_t index() const noexcept;  ///< Position in config::Model::drives.
  [[nodiscard]] const Image& image() const noexcept;
  [[nodiscard]] const canopen::NodeStatus& status() const noexcept;
  [[nodiscard]] const Alarm& alarm(AlarmKind kind) const noexcept;
  /// Any alarm of a fault's severity is active / of a warning's.
  [[nodiscard]] bool has_fault_alarm() const noexcept;
  [[nodiscard]] bool has_warning_alarm() const noexcept;

  /// Writes signals, checked altogether before anything is sent (writer, access, type, range, drive reachable), then by
  /// RPDO or SDO. Confirmed when it returns a value. The error's detail names what was already written.
  boost::asio::awaitable<Outcome> write(Writer writer, std::vector<FieldWrite> fields, StillStands still_stands = {});
  boost::asio::awaitable<Outcome> nmt(Writer writer, canopen::NmtCommand command);
  /// Any object. A read needs no writer's permission; a write of an object that is no writable signal needs `raw`, and
  /// one that is goes the signal's way with its limits.
  boost::asio::awaitable<canopen::Result<canopen::Raw>> sdo_read(canopen::ObjectAddress object, canopen::DataType type);
  boost::asio::awaitable<Outcome> sdo_write(Writer writer, canopen::ObjectValue value);

  /// The emergency alarm as the broker still holds it from before our start; shown as not confirmed until the drive was
  /// booted or taken over. After that the drive's own word stands, and an error that is still active keeps its id.
  void restore_emcy(const Alarm& alarm);

 private:
  class Body;
  std::unique_ptr<Body> body_;
};

}  // namespace process
