#pragma once

#include <algorithm>
#include <deque>

#include "bridges/process/pending_command.h"
#include "canopen/event.h"

namespace process {

/// Commands of one drive in order of arrival, the first one at a time. Outlives its places.
class CommandLane {
 public:
  /// `changed` is told when somebody leaves.
  explicit CommandLane(canopen::Event& changed) : changed_(changed) {}

  /// A command's place, from its arrival to its answer.
  class Place {
   public:
    /// `first`: before everything that has not begun, but for others of that kind.
    Place(CommandLane& lane, PendingCommand& command, bool first = false) : lane_(lane), command_(command) {
      auto& commands = lane_.commands_;
      command_.goes_first = first;
      const auto later = std::find_if(commands.begin(), commands.end(),
                                      [](const PendingCommand* other) { return !other->begun && !other->goes_first; });
      commands.insert(first ? later : commands.end(), &command_);
    }
    ~Place() {
      std::erase(lane_.commands_, &command_);
      lane_.changed_.notify();
    }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

   private:
    CommandLane& lane_;
    PendingCommand& command_;
  };

  [[nodiscard]] bool empty() const noexcept { return commands_.empty(); }
  [[nodiscard]] bool is_first(const PendingCommand& command) const noexcept {
    return !commands_.empty() && commands_.front() == &command;
  }
  /// The one whose turn it is, once it has begun; null where there is none.
  [[nodiscard]] PendingCommand* under_way() const noexcept {
    return !commands_.empty() && commands_.front()->begun ? commands_.front() : nullptr;
  }
  [[nodiscard]] const std::deque<PendingCommand*>& all() const noexcept { return commands_; }

 private:
  canopen::Event& changed_;
  std::deque<PendingCommand*> commands_;
};

}  // namespace process
