#pragma once

#include <cstddef>
#include <string>
#include <unordered_map>
#include <vector>

#include "bridges/alarms/alarm.h"
#include "bridges/mqtt/kept_topic.h"
#include "bridges/mqtt/message.h"
#include "bridges/mqtt/topics.h"
#include "bridges/process/plant.h"
#include "bridges/process/plant_change.h"
#include "canopen/clock.h"

namespace mqtt {

/// The topics of all alarms, and the list of those that are active. Each is published when it changed, paced by
/// alarms::AlarmPace; put right where somebody else wrote there; left as it is while its alarm is not known, the list
/// while none is active and not all are known. The marks
/// return when to come to collect(); kNever where nothing is due.
class AlarmTopics {
 public:
  /// Both outlive it.
  AlarmTopics(const process::Plant& plant, const Topics& topics);

  canopen::TimePoint mark(const process::Drive& drive, alarms::AlarmKind kind, canopen::TimePoint now);
  canopen::TimePoint mark_bus(std::size_t bus, canopen::TimePoint now);
  /// The plant and the topics changed. A topic that stays has its word; what is new is due, and so is the list.
  void change(const process::PlantChange& change, canopen::TimePoint now);
  /// Everything is due: a new connection.
  void mark_all();
  /// Of any topic that Topics::watched_subscriptions() match; nothing is done about those that are not ours.
  canopen::TimePoint received(const Incoming& message, canopen::TimePoint now);

  /// Appends what is due; returns when something is due next.
  canopen::TimePoint collect(canopen::TimePoint now, std::vector<Message>& out);
  /// Appends what is held back: the end is near, and nothing is collected later.
  void collect_last(std::vector<Message>& out);

 private:
  struct Entry {
    const std::string* topic = nullptr;
    const alarms::Alarm* alarm = nullptr;  ///< Null: it is the list.
    KeptTopic kept;
  };

  void add(const std::string& topic, const alarms::Alarm* alarm);
  /// Of all there is now.
  void add_all();
  canopen::TimePoint mark(std::size_t position, canopen::TimePoint now);
  void collect(Entry& entry, canopen::TimePoint now, std::vector<Message>& out);
  [[nodiscard]] std::string list() const;
  /// All alarms are known, or one of them is or was known to be active.
  [[nodiscard]] bool list_is_known();

  const process::Plant& plant_;
  const Topics& topics_;
  bool list_known_ = false;
  std::vector<Entry> entries_;  ///< Kinds of the first drive, of the next ...; buses; the list.
  std::unordered_map<std::string, std::size_t> positions_;  ///< By topic.
};

}  // namespace mqtt
