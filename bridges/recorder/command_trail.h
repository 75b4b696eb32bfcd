#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "bridges/process/command.h"
#include "bridges/process/command_journal.h"
#include "canopen/clock.h"

namespace recorder {

/// A command that was answered, as a line of the journal says it, in JSON: when it arrived, writer, drive, outcome,
/// what was asked.
[[nodiscard]] std::string command_text(const process::CommandRecord& record, const process::Outcome& outcome,
                                       canopen::TimePoint now);

/// The commands of the last while.
class CommandTrail {
 public:
  static constexpr std::size_t kMost = 1000;

  struct Taken {
    std::vector<std::string> commands;  ///< JSON objects, oldest first.
    std::size_t left_out = 0;           ///< Older ones, for which there was no room.
  };

  /// `wanted_from`: what was answered before is forgotten.
  void add(std::string text, canopen::TimePoint now, canopen::TimePoint wanted_from);
  /// Those that were answered since then.
  [[nodiscard]] Taken since(canopen::TimePoint from) const;

 private:
  struct Answered {
    canopen::TimePoint at;
    std::string text;
  };
  std::deque<Answered> commands_;
  std::deque<canopen::TimePoint> left_out_;  ///< When those were answered that had no room; no more than kMost.
};

}  // namespace recorder
