#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>

#include "canopen/clock.h"
#include "canopen/event.h"

namespace canopen {

/// Why one life of a node ended.
enum class LifeEnd : std::uint8_t {
  none,      ///< It goes on.
  boot_up,   ///< The node has rebooted.
  lost,      ///< Nothing was heard of it for too long.
  bus_down,  ///< Nothing can be heard.
  reset,     ///< We have reset it.
  started,   ///< Somebody else has started it.
  left,      ///< It left operational.
  heard,     ///< It was silent, and was heard.
  wanted,    ///< An NMT start command asks for a boot, or for another look.
  restart,   ///< It left operational, and is to be started again.
  removed    ///< No more of it is wanted.
};

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

  [[nodiscard]] bool over() const noexcept { return end_ != LifeEnd::none; }
  [[nodiscard]] LifeEnd end() const noexcept { return end_; }
  /// The first end counts.
  void end(LifeEnd end) noexcept { end_ = over() ? end_ : end; }

  /// Returns when something was heard or asked for, or the life is over; at the latest at `until`.
  boost::asio::awaitable<void> wait_until(TimePoint until) { return changed_.wait_until(until); }

 private:
  Event& changed_;
  LifeEnd end_ = LifeEnd::none;
};

}  // namespace canopen
