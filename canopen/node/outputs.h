#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "canopen/bus/ticket.h"
#include "canopen/clock.h"
#include "canopen/error.h"
#include "canopen/event.h"
#include "canopen/node/node_settings.h"
#include "canopen/node/rpdo.h"
#include "canopen/wake_up.h"

namespace canopen {

class Bus;

/// The RPDOs of one node: builds, sends and confirms them, one at a time, so that each is built on what the one before
/// has left behind. An RPDO whose reception the node supervises (its event timer, CiA 301 §7.5.2.35) is repeated three
/// times per event timer from its first departure on, as long as it is not void.
class Outputs {
 public:
  /// `bus` outlives it.
  Outputs(const boost::asio::any_io_executor& executor, Bus& bus, std::uint8_t node,
          std::span<const PdoSettings> rpdos);

  /// The RPDO that maps `object` as commanded; 0: none.
  [[nodiscard]] std::uint16_t rpdo_of(ObjectAddress object) const noexcept;
  [[nodiscard]] bool complete(std::uint16_t number, std::span<const ObjectValue> fields) const noexcept;
  boost::asio::awaitable<Result<void>> send(std::uint16_t number, std::vector<ObjectValue> fields, TimePoint deadline);
  /// A command of `object` goes by SDO now: its RPDO is not repeated before note(), or it would bring back the value of
  /// before; a repetition that waits to leave is withdrawn. However many writes follow each other and however long one
  /// takes, this keeps repetitions back by one period at most.
  void hold(ObjectAddress object);
  /// The SDO write is confirmed. A repetition that was kept back, or left with the value of before, follows at once.
  void note(const ObjectValue& value);
  void forget(ObjectAddress object);

  /// The node was lost, rebooted, left operational or is being removed: nothing is known, nothing repeated, and what
  /// waits to leave is withdrawn.
  void cease();
  /// The motor faulted or came to a stop: nothing is known any more. A waiting RPDO that relies on something known is
  /// withdrawn; one whose fields were all given anew may go. `keep_repeating`: supervised RPDOs go on unchanged.
  void make_void(bool keep_repeating);

  /// Returns once nothing is under way or waits; to be awaited after cease() before it goes.
  boost::asio::awaitable<void> until_idle();

 private:
  class Turn;
  struct Entry {
    Entry(Outputs& owner, const boost::asio::any_io_executor& executor, const PdoSettings& settings);

    Rpdo rpdo;
    Duration period;  ///< Of its repetition; zero: not repeated.
    TimePoint due{};  ///< Of the next repetition.
    /// Of the pause for SDO writes, which ends earlier when an RPDO has left. No time: no pause.
    TimePoint pause_end{};
    Ticket repetition{};  ///< The newest one since the last command or pause.
    Frame repeated{};     ///< What it holds.
    WakeUp wake_up;
  };

  boost::asio::awaitable<Result<void>> transmit(Turn& turn, std::span<const ObjectValue> fields, TimePoint deadline);
  void on_due(Entry& entry);
  void repeat(Entry& entry);
  /// The one that waits for its RPDO's departure; nothing where none does.
  [[nodiscard]] Turn* under_way() const noexcept;
  [[nodiscard]] Error error(ErrorKind kind, std::string detail) const;

  Bus& bus_;
  std::uint8_t node_;
  std::deque<Entry> entries_;
  Event turn_event_;
  std::deque<Turn*> turns_;  ///< The first one sends.
};

}  // namespace canopen
