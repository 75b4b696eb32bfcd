#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <string>
#include <vector>

#include "bridges/process/observer.h"
#include "bridges/process/plant.h"
#include "daemon/alarm_log.h"
#include "daemon/command_log.h"

namespace gateway {

/// Writes what an operator wants to read afterwards: drives coming and going, alarms, bus states, commands. Never a
/// line per frame or value.
class EventLog final : public process::Observer {
 public:
  EventLog(const boost::asio::any_io_executor& executor, const process::Plant& plant);

  void on_values(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_freshness(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_commanded(const process::Drive& drive, std::span<const process::SignalId> signals) override;
  void on_status(const process::Drive& drive) override;
  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind) override;
  void on_bus(std::size_t bus) override;
  void on_bus_alarm(std::size_t bus) override;
  void on_plant_change(const process::PlantChange& change) override;
  /// The end: lines that are held back are written.
  void finish() { alarms_.finish(); }
  void on_remark(const process::Drive& drive, const std::string& text) override;
  void on_command_done(const process::Drive& drive, const process::CommandRecord& record,
                       const process::Outcome& outcome) override;

 private:
  struct Told {
    bool online = false;
    canopen::NmtState nmt = canopen::NmtState::unknown;
  };

  std::vector<Told> told_;
  AlarmLog alarms_;
  CommandLog commands_;
};

}  // namespace gateway
