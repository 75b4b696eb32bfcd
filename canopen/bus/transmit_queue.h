#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "canopen/bus/in_flight.h"
#include "canopen/bus/link.h"
#include "canopen/bus/ticket.h"
#include "canopen/bus/transmit_class.h"
#include "canopen/bus/transmit_times.h"
#include "canopen/clock.h"
#include "canopen/frame.h"

namespace canopen {

/// Everything that waits to leave on one bus, by class, then COB-ID, then age. The kernel gets very few frames at a
/// time, the next one when an echo came back: so a frame past its time is dropped here instead of leaving when a cable
/// is plugged in an hour later. In the kernel are at most:
/// - one that can move a motor or stop it (stop, NMT, command, repetition), and only while the bus shows life and no
///   frame of ours is stuck. Without its echo in time no other one follows until an echo proves that it has gone;
/// - one of each COB-ID of control, so that nothing keeps our heartbeat and SYNC back, nor one the other;
/// - one of SDO.
/// The last two give their place to the next of their kind once their echo is late on a bus that lives, or may have
/// been lost. What can move a motor still waits for the proof that they have gone (InFlight).
///
/// A stop waits for its place behind the frame that moves a motor, so that they leave in that order, and until its time
/// for the proof that such a frame has gone; but for nothing else of ours. A full queue makes room for it.
///
/// Has no timer of its own: the owner calls service() at next_time() and after each event.
class TransmitQueue {
 public:
  /// Called once, possibly from inside push(); must not call the queue or a ticket.
  using Told = Ticket::Told;

  static constexpr std::size_t kCapacity = 1024;
  static constexpr Duration kLifeTime = std::chrono::seconds(1);    ///< Of a frame without a deadline of its own.
  static constexpr Duration kSignOfLife = std::chrono::seconds(1);  ///< Commands go while the last sign is not older.
  static constexpr Duration kRetry = std::chrono::milliseconds(2);  ///< After `busy`, where no echo comes first;
  static constexpr Duration kLongestRetry = std::chrono::milliseconds(32);  ///< doubled each time up to this.

  /// `has_heartbeat`: the owner sends our heartbeat where wants_heartbeat() says so. Else no proof can be had at will:
  /// any later echo counts as one, and what is late and moves no motor is not asked after.
  explicit TransmitQueue(Link& link, TransmitTimes times = {}, bool has_heartbeat = true);
  ~TransmitQueue() = default;
  TransmitQueue(const TransmitQueue&) = delete;
  TransmitQueue& operator=(const TransmitQueue&) = delete;

  /// Queues a frame that is to be with the kernel before `until`. The ticket must go before the queue. For a stop the
  /// newest frame of the lowest class is withdrawn where the queue is full.
  [[nodiscard]] Ticket push(TransmitClass transmit_class, const Frame& frame, TimePoint until, Told told,
                            TimePoint now);

  void on_echo(const Frame& frame, TimePoint at);
  void on_received(TimePoint at) noexcept { last_sign_of_life_ = at; }
  /// Received frames were lost, and with them perhaps echoes.
  void on_frames_lost();
  /// For what is handed over from now on.
  void set_times(TransmitTimes times) noexcept { in_flight_.set_times(times); }
  /// The bus came up or went down. What waits is dropped and answered when it goes down.
  void on_bus(bool up);

  /// Drops and answers what is past its time, and hands over what may go.
  void service(TimePoint now);
  /// Lies in the past while the link lags behind.
  [[nodiscard]] std::optional<TimePoint> next_time() const noexcept;
  [[nodiscard]] bool idle() const noexcept { return waiting_.empty(); }
  /// Since when nothing of ours has left although something was to: handed over without an echo, or not taken.
  [[nodiscard]] std::optional<TimePoint> unsent_since() const noexcept { return unsent_since_; }
  /// A heartbeat of ours would tell what is not known: whether the bus lives, where only commands and repetitions wait;
  /// or whether a frame has gone whose echo is missing, and which one of them waits for.
  [[nodiscard]] bool wants_heartbeat(TimePoint now) const noexcept;

 private:
  friend class Ticket;

  [[nodiscard]] bool make_room(TransmitClass for_class);
  [[nodiscard]] bool waits(std::uint64_t id) const noexcept;
  void drop(std::uint64_t id);
  void withdraw(std::uint64_t id);
  [[nodiscard]] bool alive(TimePoint now) const noexcept;
  [[nodiscard]] bool may_go(const Outgoing& entry, TimePoint now) const noexcept;
  [[nodiscard]] bool motion_waits() const noexcept;
  void hand_over(TimePoint now);
  void forget_unsent() noexcept;
  /// Drops and answers those of which `which` says so.
  template <class Which>
  void drop_waiting(Which which, Departure departure);

  Link& link_;
  InFlight in_flight_;
  std::vector<Outgoing> waiting_;  ///< The next one to go is the last.
  std::uint64_t last_id_ = 0;
  std::optional<TimePoint> last_sign_of_life_;
  std::optional<TimePoint> unsent_since_;
  bool unsent_taken_ = false;  ///< Since then a frame was handed over.
  std::optional<TimePoint> retry_at_;
  Duration retry_pause_ = kRetry;
  bool up_ = false;
};

}  // namespace canopen
