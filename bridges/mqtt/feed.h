#pragma once

#include <bitset>
#include <optional>
#include <span>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/pace.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/drive.h"
#include "config/model.h"

namespace mqtt {

/// What one drive has to tell: marks what changed as it happens, and writes it out once per turn of the loop.
/// The marks return when something is due; TimePoint::max() where nothing is.
class Feed {
 public:
  /// All outlive the feed.
  Feed(const process::Drive& drive, const DriveTopics& topics, const config::Mqtt& settings);

  canopen::TimePoint mark_values(std::span<const process::SignalId> signals, canopen::TimePoint now);
  canopen::TimePoint mark_status(canopen::TimePoint now);
  canopen::TimePoint mark_alarm(alarms::AlarmKind kind, canopen::TimePoint now);
  canopen::TimePoint mark_control(canopen::TimePoint now);
  /// Everything is due: a new connection.
  void mark_all();

  /// Appends what is due; returns when something is due next.
  canopen::TimePoint collect(canopen::TimePoint now, std::vector<Message>& out);

  /// What an orderly end says of the drive.
  [[nodiscard]] Message offline() const;

 private:
  /// Returns when those that it held back are due.
  canopen::TimePoint collect_alarms(canopen::TimePoint now, std::vector<Message>& out);
  void collect_signals(canopen::TimePoint now, std::vector<Message>& out);
  void collect_state(canopen::TimePoint now, std::vector<Message>& out);

  const process::Drive& drive_;
  const DriveTopics& topics_;
  const config::Mqtt& settings_;
  Pace pace_;
  std::optional<bool> online_;  ///< As published.
  std::optional<canopen::NmtState> nmt_;
  bool fresh_ = false;
  bool control_due_ = true;
  /// The drive was once online, lost, or found with a boot error. Until then its alarms are those on the broker: to
  /// call them over for the seconds that a search takes would be no news but a mistake.
  bool learnt_ = false;
  std::optional<canopen::TimePoint> first_;  ///< When it first had something to tell.
  std::bitset<alarms::kAlarmKinds.size()> alarms_due_;
};

}  // namespace mqtt
