#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "bridges/alarms/alarm_pace.h"
#include "bridges/mqtt/put_right.h"
#include "canopen/clock.h"

namespace mqtt {

/// One retained topic whose last word is ours: when it is published, and when it is put right because somebody else
/// wrote there. Knows nothing of the word but its text.
class KeptTopic {
 public:
  /// The word may have changed. Returns when to come.
  canopen::TimePoint changed(canopen::TimePoint now) { return announce_ ? now : pace_.note(now); }
  /// A new connection: the word is due whatever it is.
  void forget();
  /// This was published there, by somebody else or by us. Returns when to come.
  canopen::TimePoint received(std::string_view payload, canopen::TimePoint now);

  /// When to come: now or earlier means that it is to be offered or withheld.
  [[nodiscard]] canopen::TimePoint next() const;
  /// The word as it is. True where it is to be published now.
  [[nodiscard]] bool offer(const std::string& word, canopen::TimePoint now);
  /// The word of the last offer() that was true takes the place of somebody else's.
  [[nodiscard]] bool puts_right() const noexcept { return puts_right_; }
  /// There is no word yet: the topic stays as it is.
  void withhold();

 private:
  alarms::AlarmPace pace_;
  bool announce_ = true;
  bool withheld_ = false;             ///< On this connection, and no word since.
  std::optional<std::string> word_;   ///< As published on this connection.
  std::optional<std::string> older_;  ///< The one that was published before it.
  PutRight put_right_;
  bool puts_right_ = false;
};

}  // namespace mqtt
