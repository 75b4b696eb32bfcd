#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <tuple>

#include "bridges/process/command.h"
#include "bridges/process/command_journal.h"
#include "canopen/clock.h"

namespace gateway {

/// One line for each command, for people:
/// `pump1: modbus 192.0.2.7: control_command 1, frequency_command 30.00 Hz: ok in 12 ms (id a1)`.
///
/// Set-points of one writer to one drive, and refusals of one kind, of which nothing was sent, are at most a line a
/// second, refusals of a Modbus client a line a minute; the next line tells how many were left out. Whatever else may
/// have moved a motor has a line always.
class CommandLog {
 public:
  using Write = std::function<void(const std::string& line)>;

  explicit CommandLog(Write write) : write_(std::move(write)) {}

  /// A command was answered at `now`.
  void on_done(const process::CommandRecord& record, const process::Outcome& outcome, canopen::TimePoint now);

 private:
  /// Drive, writer, and what kind of line.
  using Kind = std::tuple<std::string, std::string, std::string>;
  struct Paced {
    canopen::TimePoint until{};  ///< The next line.
    std::size_t left_out = 0;
  };

  void end_pauses(const Kind& but, canopen::TimePoint now);

  Write write_;
  std::map<Kind, Paced> paced_;  ///< Whose pause runs, or with lines left out.
};

}  // namespace gateway
