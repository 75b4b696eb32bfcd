#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "bridges/alarms/alarm.h"
#include "bridges/process/image.h"

namespace process {

class Drive;
struct CommandRecord;
struct Outcome;
struct PlantChange;

/// What a bridge is told, in the same synchronous call in which it happened. It never calls back into the drive from
/// inside, but reads it as it likes. Nothing here waits.
class Observer {
 public:
  /// These signals were received (whether their value changed or not), all of one source, in order of position.
  virtual void on_values(const Drive& drive, std::span<const SignalId> signals) = 0;
  /// These signals are not fresh any more, or freshness came back without a new value.
  virtual void on_freshness(const Drive& drive, std::span<const SignalId> signals) = 0;
  /// A command was confirmed: Drive::commanded() of these changed.
  virtual void on_commanded(const Drive& drive, std::span<const SignalId> signals) = 0;
  /// Who keeps the drive to himself, or what a time-out did: Drive::control() changed.
  virtual void on_control(const Drive& /*drive*/) {}
  /// A command was answered.
  virtual void on_command_done(const Drive& /*drive*/, const CommandRecord& /*record*/, const Outcome& /*outcome*/) {}
  /// Online, NMT state, boot result or counters changed.
  virtual void on_status(const Drive& drive) = 0;
  virtual void on_alarm(const Drive& drive, alarms::AlarmKind kind) = 0;
  /// State of a bus changed (position in config::Model::buses), or its error counters.
  virtual void on_bus(std::size_t bus) = 0;
  /// Its alarm looks different.
  virtual void on_bus_alarm(std::size_t /*bus*/) {}
  /// Something about a drive that a person should know and nothing acts upon: for the log.
  virtual void on_remark(const Drive& /*drive*/, const std::string& /*text*/) {}

  /// The configuration changed while the plant runs: Plant::model() is another one, and drives and buses have other
  /// positions. A drive that stays is the same object; one that left is stopped, and
  /// goes some time after this call. The new ones have not
  /// started.
  virtual void on_plant_change(const PlantChange& /*change*/) {}

 protected:
  ~Observer() = default;
};

}  // namespace process
