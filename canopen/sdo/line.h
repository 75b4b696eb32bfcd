#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <initializer_list>
#include <optional>

#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/event.h"
#include "canopen/sdo/budget.h"

namespace canopen {

/// The line of those who want an SDO channel, where one has it at a time. Stops go before commands, and these before
/// everything else that waits; the others have their turn only once the budget of the bus lets them, so no command
/// waits for that.
class SdoLine {
 public:
  enum class Kind : std::uint8_t { transfer, command, stop };
  class Place;

  /// `budget` outlives the line.
  SdoLine(boost::asio::any_io_executor executor, SdoBudget& budget);
  ~SdoLine() = default;
  SdoLine(const SdoLine&) = delete;
  SdoLine& operator=(const SdoLine&) = delete;

  /// Calls off everybody of these kinds who is in the line now.
  void call_off(std::initializer_list<Kind> kinds, const Error& why);
  /// Calls off the one who has the channel, where that is a command.
  void call_off_held_command(const Error& why);

  [[nodiscard]] bool empty() const noexcept { return places_.empty(); }
  [[nodiscard]] bool held_by_transfer() const noexcept;
  boost::asio::awaitable<void> until_empty();

 private:
  void insert(Place* place);
  [[nodiscard]] bool is_next(const Place* place) const noexcept;

  SdoBudget& budget_;
  std::deque<Place*> places_;
  Place* holder_ = nullptr;  ///< Has the channel.
  Event moved_;              ///< Somebody left, gave way, may go, or was called off.
};

/// A place in the line, as long as it lives.
class SdoLine::Place {
 public:
  /// `due`: the order in which the budget serves transfers.
  Place(SdoLine& line, Kind kind, TimePoint due);
  ~Place();
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  /// False where it was called off first, or `deadline` passed.
  boost::asio::awaitable<bool> wait_until(TimePoint deadline);
  /// Lets stops and commands go first, those that come until then, too. To be awaited by the one who has the channel;
  /// false where nobody else had it meanwhile.
  boost::asio::awaitable<bool> step_aside(TimePoint until);
  /// Why it does not have the channel, or is not to use it any more.
  [[nodiscard]] const std::optional<Error>& called_off() const noexcept { return called_off_; }

 private:
  friend class SdoLine;
  [[nodiscard]] bool may_go() const noexcept { return !claim_ || claim_->granted(); }

  SdoLine& line_;
  Kind kind_;
  std::optional<Error> called_off_;
  std::optional<SdoBudget::Claim> claim_;  ///< Of a transfer.
};

}  // namespace canopen
