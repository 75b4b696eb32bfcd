#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bridges/alarms/active_alarms_json.h"
#include "bridges/process/plant.h"
#include "daemon/http/answer.h"

namespace gateway::http {

/// The JSON of `B/alarms`, worded in pieces: the alarms that are active when it is made, oldest first. The plant
/// outlives it.
class AlarmList {
 public:
  /// Alarms that a piece has: some quarter of a millisecond's work.
  static constexpr std::size_t kOfPiece = 100;

  explicit AlarmList(const process::Plant& plant);

  /// Appends the next piece of `[{…},{…}]`, of so many alarms at most.
  Progress word(std::string& out, std::size_t most = kOfPiece);

 private:
  struct Listed {
    alarms::ListedAlarm place;  ///< Its pointer to the alarm is set while it is worded.
    alarms::Alarm alarm;        ///< As it was; what the list does not show is left out.
  };

  std::vector<Listed> listed_;
  std::size_t next_ = 0;
};

}  // namespace gateway::http
