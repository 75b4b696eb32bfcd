#pragma once

#include <string>

#include "bridges/process/command_journal.h"
#include "config/model.h"

namespace journal {

/// A drive with the signals 0 `control_command`, 1 `frequency_command` (0.01 Hz).
inline config::Drive make_pump() {
  config::Drive drive;
  drive.name = "pump1";
  config::Signal control;
  control.name = "control_command";
  config::Signal frequency;
  frequency.name = "frequency_command";
  frequency.scale = 0.01;
  frequency.decimals = 2;
  drive.signals = {control, frequency};
  return drive;
}

/// A Modbus client writes these.
inline process::CommandRecord make_write(const config::Drive& drive, const std::string& id,
                                         std::vector<process::FieldRecord> fields) {
  process::CommandRecord record;
  record.id = id;
  record.writer = {process::Writer::Way::modbus, "192.0.2.7"};
  record.drive = &drive;
  record.fields = std::move(fields);
  for (const process::FieldRecord& field : record.fields) {
    record.writes_control = record.writes_control || field.signal == 0;
  }
  record.arrived = canopen::Clock::now();
  record.wall = canopen::wall_now();
  return record;
}

}  // namespace journal
