#pragma once

#include <boost/asio/awaitable.hpp>

#include "canopen/clock.h"
#include "canopen/event.h"

namespace canopen {

/// What was begun with a node from one look at its state to the next. A procedure that goes on with a node asks after
/// each wait whether its life is over: what it knows of the node is void then, and all that was queued is withdrawn.
/// Ended by the handlers of frames and by commands (RemoteNode::end_life), owned by the coroutine that lives it.
class Life {
 public:
  /// `changed` outlives the life.
  explicit Life(Event& changed) : changed_(changed) {}
  ~Life() = default;
  Life(const Life&) = delete;
  Life& operator=(const Life&) = delete;

  [[nodiscard]] bool over() const noexcept { return over_; }
  void end() noexcept { over_ = true; }

  /// Returns when something was heard or asked for, or the life is over; at the latest at `until`.
  boost::asio::awaitable<void> wait_until(TimePoint until) { return changed_.wait_until(until); }

 private:
  Event& changed_;
  bool over_ = false;
};

}  // namespace canopen
