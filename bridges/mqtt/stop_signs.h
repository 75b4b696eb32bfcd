#pragma once

#include <memory>
#include <mutex>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/topics.h"
#include "config/model.h"

namespace mqtt {

/// Tells a command that stops a motor from all others, by the configuration alone, on any thread.
///
/// Paho's threads ask while the loop replaces the configuration of the plant, so nothing here is shared with that but
/// the model, which never changes: which one it is is read and replaced under the mutex. Of Topics only route() is
/// asked, which looks at nothing that ever changes. No stop is lost by a change: a drive that stays is judged alike
/// before and after it; what is asked in between is asked of the drives as they were, and is looked at again on the
/// loop, where it arrives after the change.
class StopSigns {
 public:
  /// `topics` outlives it.
  StopSigns(std::shared_ptr<const config::Model> model, const Topics& topics);

  /// On the loop: the configuration is another one.
  void change(std::shared_ptr<const config::Model> model);
  /// It stops a drive that may be stopped by MQTT, or all.
  [[nodiscard]] bool is_stop(const Incoming& incoming) const;

 private:
  const Topics& topics_;
  mutable std::mutex mutex_;
  std::shared_ptr<const config::Model> model_;
};

}  // namespace mqtt
