#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
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
class RpdoSender {
 public:
  /// `bus` outlives the sender.
  RpdoSender(const boost::asio::any_io_executor& executor, Bus& bus, std::uint8_t node,
             std::span<const PdoSettings> rpdos);

  [[nodiscard]] std::uint16_t rpdo_of(ObjectAddress object) const noexcept;
  [[nodiscard]] bool complete(std::uint16_t number, std::span<const ObjectValue> fields) const noexcept;
  boost::asio::awaitable<Result<void>> send(std::uint16_t number, std::vector<ObjectValue> fields, TimePoint deadline);
  /// A command of `object` goes by SDO now: its RPDO is not repeated until note(), or it would bring back the value of
  /// before; a repetition that waits to leave is withdrawn. Repeated calls do not make the pause longer than one
  /// period.
  void hold(ObjectAddress object) noexcept;
  void note(const ObjectValue& value) noexcept;
  void forget(ObjectAddress object) noexcept;

  /// The node was lost, rebooted, left operational or is being removed: nothing is known, nothing repeated, and what
  /// waits to leave is withdrawn.
  void cease();
  /// The motor faulted or came to a stop: nothing is known any more. A waiting RPDO that relies on something known is
  /// withdrawn; one whose fields were all given anew may go. `keep_repeating`: supervised RPDOs go on unchanged.
  void make_void(bool keep_repeating);

  /// Returns once nothing is under way or waits; to be awaited after cease() before the sender goes.
  boost::asio::awaitable<void> until_idle();

 private:
  class Turn;
  struct Entry {
    Rpdo rpdo;
    Rpdo blank;       ///< Never commanded: tells whether fields are complete by themselves.
    Duration repeat;  ///< Zero: not repeated.
    std::unique_ptr<WakeUp> repetition;
    TimePoint held_until{};
    Ticket repeated{};       ///< The newest repetition.
    Frame repeated_frame{};  ///< What it holds.
  };

  boost::asio::awaitable<Result<void>> transmit(Turn& turn, Entry& entry, std::vector<ObjectValue> fields,
                                                TimePoint deadline);
  void repeat(Entry& entry);
  /// The one that waits for its RPDO's departure; nothing where none does.
  [[nodiscard]] Turn* under_way() const noexcept;
  [[nodiscard]] Entry* find(std::uint16_t number) noexcept;
  [[nodiscard]] const Entry* find(std::uint16_t number) const noexcept;
  [[nodiscard]] Error error(ErrorKind kind, std::string detail) const;

  boost::asio::any_io_executor executor_;
  Bus& bus_;
  std::uint8_t node_;
  std::vector<Entry> entries_;
  Event turn_event_;
  std::deque<Turn*> users_;  ///< The first one sends.
};

}  // namespace canopen
