#pragma once

#include <spdlog/common.h>

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bridges/alarms/alarm_pace.h"
#include "bridges/process/plant.h"
#include "canopen/wake_up.h"

namespace gateway {

/// Lines about alarms and about what buses do, for people:
/// `pump1: alarm emcy active, first: 0x0005 Overcurrent during acceleration`.
///
/// However many changes there are, each alarm and each bus has at most two lines a second, the first at once and the
/// last state always; a line tells how many activations had none. No line says the same of the same activation as the
/// one before it.
class AlarmLog {
 public:
  using Write = std::function<void(spdlog::level::level_enum level, const std::string& line)>;

  /// `plant` outlives it.
  AlarmLog(const boost::asio::any_io_executor& executor, const process::Plant& plant, Write write);

  void on_alarm(const process::Drive& drive, alarms::AlarmKind kind);
  /// Its state, or its alarm.
  void on_bus(std::size_t bus);
  /// What stays goes on as it is; of what left nothing more is told.
  void on_plant_change(const process::PlantChange& change);
  /// The end: what is held back is written now.
  void finish();

 private:
  struct Line {
    spdlog::level::level_enum level = spdlog::level::info;
    std::string text;
  };
  struct Subject {
    alarms::AlarmPace pace;
    std::string line;                    ///< As told; empty: nothing yet.
    std::string id;                      ///< Alarm::id as told.
    std::optional<std::uint32_t> count;  ///< Alarm::count as told.
  };

  /// Drives, their alarms before the buses.
  [[nodiscard]] std::size_t of_drives() const { return subjects_.size() - buses_; }
  void note(std::size_t subject);
  void tell_due();
  void tell(std::size_t subject);
  [[nodiscard]] bool is_told(std::size_t subject) const;
  [[nodiscard]] Line line_of(std::size_t subject) const;
  [[nodiscard]] Line line_of(const process::Drive& drive, alarms::AlarmKind kind, const Subject& subject) const;
  [[nodiscard]] const alarms::Alarm& alarm_of(std::size_t subject) const;

  const process::Plant& plant_;
  Write write_;
  std::vector<Subject> subjects_;  ///< The alarms of the drives, then the buses.
  std::size_t buses_;
  /// By Alarm::id what was told when the plant last changed: a drive that is another one from then on has it still.
  std::map<std::string, Subject> handed_over_;
  canopen::WakeUp next_;
};

}  // namespace gateway
