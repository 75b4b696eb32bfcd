#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/command_journal.h"
#include "bridges/process/commanded.h"
#include "bridges/process/control_use.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/sdo/stop_limit.h"

namespace process {

/// A command from its arrival to its answer. Lives in the coroutine that carries it out.
struct PendingCommand {
  CommandRecord record;
  std::uint64_t number = 0;            ///< In order of arrival.
  canopen::TimePoint arrived_until{};  ///< record.arrived, or where that is not sure, the latest it may have been.
  canopen::TimePoint deadline{};
  canopen::TimePoint expires = canopen::TimePoint::max();
  Commanded::Epoch epoch = 0;  ///< At its arrival.
  ControlUse use = ControlUse::none;
  bool set_points_only = false;  ///< A later one of the same signals supersedes it.
  bool passes_lease = false;     ///< What a time-out writes.
  bool relies_on_bits = false;   ///< It changes some bits of what stands: it supersedes nothing.

  bool begun = false;                     ///< It has its turn.
  bool goes_first = false;                ///< In its lane: before what is not.
  bool left = false;                      ///< A stop: an RPDO of it has left, or may have.
  canopen::StopLimit stop_limit{};        ///< A stop: a newer one waits,
  canopen::StopLimit read_limit{};        ///< and is another one.
  bool noted = false;                     ///< Its begin stands in the journal.
  bool carries_control = false;           ///< So does its step under way.
  bool withdrawn = false;                 ///< Its step under way was called back, to be looked at again.
  std::optional<canopen::Error> ended{};  ///< It is not to be begun any more.

  std::size_t written = 0;      ///< Fields confirmed.
  std::string written_names{};  ///< For people.
  std::string note{};
};

}  // namespace process
