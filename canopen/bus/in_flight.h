#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "canopen/bus/ticket.h"
#include "canopen/bus/transmit_class.h"
#include "canopen/bus/transmit_times.h"
#include "canopen/clock.h"
#include "canopen/frame.h"

namespace canopen {

/// A frame that is to leave.
struct Outgoing {
  Frame frame;
  TransmitClass transmit_class;
  TimePoint until;   ///< To be with the kernel before.
  std::uint64_t id;  ///< Of its ticket.
  Ticket::Told told;
};

/// Tells once.
void tell(Ticket::Told& told, Departure departure);

/// What the kernel and the controller have of ours, until its departure is proven. Part of TransmitQueue, which says
/// what may be in there at the same time. All frames that are handed over pass through it.
///
/// Proof is a frame's own echo, or that of a later one which no controller sends before it: many send first in first
/// out, others by identifier, so it must have one that is not lower. Our heartbeat has the highest of all.
class InFlight {
 public:
  /// `has_heartbeat`: see TransmitQueue.
  InFlight(TransmitTimes times, bool has_heartbeat);
  void set_times(TransmitTimes times) noexcept { times_ = times; }

  void add(Outgoing outgoing, TimePoint now);
  void on_echo(const Frame& frame, TimePoint at);
  /// Received frames were lost, and with them perhaps echoes.
  void on_frames_lost();
  void on_down();
  /// Nobody is told of it any more.
  void forget_told(std::uint64_t id);

  /// Something was waited for until now.
  [[nodiscard]] bool any_late(TimePoint now) const noexcept;
  /// No longer waits for what is late. `last_sign_of_life` of the bus.
  void give_up_late(TimePoint now, std::optional<TimePoint> last_sign_of_life);
  /// When it is to be looked at again; `motion_waits`: for what can move a motor.
  [[nodiscard]] TimePoint next_time(bool motion_waits) const noexcept;

  [[nodiscard]] bool empty() const noexcept { return entries_.empty(); }
  /// What starts motors waits for the proof that all before it has gone, a stop only for what moves or stops motors.
  [[nodiscard]] bool leaves_room_for(TransmitClass transmit_class, const Frame& frame, TimePoint now) const noexcept;
  /// Whether a command has gone is not known, and no other is taken.
  [[nodiscard]] bool refuses_commands() const noexcept;
  /// A heartbeat of ours would prove what is not known and somebody waits for.
  [[nodiscard]] bool wants_proof(bool motion_waits, TimePoint now) const noexcept;

 private:
  struct Entry {
    Frame frame;
    TransmitClass transmit_class;
    TimePoint since;
    TimePoint look_at;  ///< What moves a motor: unknown then; others: whether they are still waited for.
    std::uint64_t id;
    Ticket::Told told;
    std::uint64_t number;              ///< Counts what was handed over.
    bool passed = false;               ///< It has gone, but its echo did not come, or comes yet.
    bool doubtful = false;             ///< Its echo may have been lost.
    bool overdue = false;              ///< The controller may still hold it: nothing else that moves a motor is taken.
    bool gone = false;                 ///< Its echo came, or is not waited for any more.
    std::optional<TimePoint> lost_at;  ///< Overdue, and the bus moves again: its echo comes by then or never.
  };
  /// Frames that others of their kind no longer wait for, although the controller may still hold them.
  struct Forgotten {
    Frame newest;
    std::uint64_t number;  ///< Of that one.
    std::uint32_t cob_id;  ///< The highest.
    TimePoint since;       ///< Of the newest.
  };

  [[nodiscard]] bool proves(std::uint32_t cob_id, std::uint32_t of_earlier) const noexcept;
  /// A frame whose echo would prove that is on its way.
  [[nodiscard]] bool will_be_proven(std::uint64_t number, std::uint32_t cob_id) const noexcept;
  void give_up_motion(Entry& entry, TimePoint now) const;
  void give_up_other(Entry& entry, TimePoint now, std::optional<TimePoint> last_sign_of_life);
  void forget(Entry& entry);
  void erase_gone();

  TransmitTimes times_;
  bool has_heartbeat_;
  std::vector<Entry> entries_;  ///< In the order of hand-over.
  std::optional<Forgotten> forgotten_;
  std::uint64_t handed_over_ = 0;
  TimePoint looked_;  ///< When give_up_late() was last called.
};

}  // namespace canopen
