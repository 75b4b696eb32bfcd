#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "canopen/bus/link.h"
#include "canopen/bus/ticket.h"
#include "canopen/bus/transmit_times.h"
#include "canopen/clock.h"
#include "canopen/frame.h"

namespace canopen {

/// What a frame is for. Lower ones leave first, whatever their COB-ID: by COB-ID alone the SDO requests of many booting
/// drives keep our heartbeat back, which has the highest one, and with it every stop by SDO.
enum class TransmitClass : std::uint8_t {
  nmt,         ///< NMT commands.
  control,     ///< SYNC, our heartbeat, guarding requests.
  command,     ///< RPDOs and SDO downloads that somebody asked for.
  repetition,  ///< Confirmed RPDOs again.
  sdo          ///< All other SDO frames, first come first served.
};

/// How the wait for a frame's departure ended.
enum class Departure : std::uint8_t {
  left,       ///< Its echo came back.
  withdrawn,  ///< Its time passed, or it was withdrawn, before the kernel had it: it can never leave.
  unknown,    ///< The kernel had it, and no echo came in time.
  offline     ///< The bus is down, or takes no command until an echo returns.
};

/// Everything that waits to leave on one bus, by class, then COB-ID, then age. The kernel gets very few frames at a
/// time, the next one when an echo came back: so a frame past its time is dropped here instead of leaving when a cable
/// is plugged in an hour later. In the kernel are at most:
/// - one that can move a motor (NMT, command, repetition), and only while the bus shows life and no frame of ours is
///   stuck. Without its echo in time no other one follows until an echo proves that it has gone;
/// - one of each COB-ID of control, so that nothing keeps our heartbeat and SYNC back, nor one the other;
/// - one of SDO.
/// The last two are no longer waited for once their echo is late on a bus that lives, or may have been lost.
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

  explicit TransmitQueue(Link& link, TransmitTimes times = {});
  ~TransmitQueue() = default;
  TransmitQueue(const TransmitQueue&) = delete;
  TransmitQueue& operator=(const TransmitQueue&) = delete;

  /// Queues a frame that is to be with the kernel before `until`. The ticket must go before the queue.
  [[nodiscard]] Ticket push(TransmitClass transmit_class, const Frame& frame, TimePoint until, Told told,
                            TimePoint now);

  void on_echo(const Frame& frame, TimePoint at);
  void on_received(TimePoint at) noexcept { last_sign_of_life_ = at; }
  /// Received frames were lost, and with them perhaps echoes.
  void on_frames_lost();
  /// The bus came up or went down. What waits is dropped and answered when it goes down.
  void on_bus(bool up);

  /// Drops and answers what is past its time, and hands over what may go.
  void service(TimePoint now);
  /// Lies in the past while the link lags behind.
  [[nodiscard]] std::optional<TimePoint> next_time() const noexcept;
  [[nodiscard]] bool idle() const noexcept { return waiting_.empty(); }
  /// A heartbeat of ours would tell what is not known: whether the bus lives, where only commands and repetitions wait;
  /// or whether a frame has gone whose echo is missing, and which one of them waits for.
  [[nodiscard]] bool wants_heartbeat(TimePoint now) const noexcept;

 private:
  friend class Ticket;
  struct Waiting {
    Frame frame;
    TransmitClass transmit_class;
    TimePoint until;
    std::uint64_t id;
    Told told;
  };
  struct InKernel {
    Frame frame;
    TransmitClass transmit_class;
    TimePoint since;
    TimePoint look_at;  ///< What moves a motor: unknown then; others: whether they are still waited for.
    std::uint64_t id;
    Told told;
    bool passed = false;               ///< A frame handed over later has come back before it.
    bool doubtful = false;             ///< Its echo may have been lost.
    bool followed = false;             ///< A frame was handed over after it, whose echo will tell.
    bool overdue = false;              ///< The controller may still hold it: nothing else that moves a motor is taken.
    bool looked_behind = false;        ///< It was looked at when others no longer followed it.
    bool gone = false;                 ///< Its echo came, or is not waited for any more.
    std::optional<TimePoint> lost_at;  ///< Overdue, and the bus moves again: its echo comes by then or never.
  };

  [[nodiscard]] bool waits(std::uint64_t id) const noexcept;
  void drop(std::uint64_t id);
  void withdraw(std::uint64_t id);
  void enqueue(Waiting entry);
  [[nodiscard]] bool refuses_commands() const noexcept;
  [[nodiscard]] bool alive(TimePoint now) const noexcept;
  [[nodiscard]] bool may_go(const Waiting& entry, TimePoint now) const noexcept;
  [[nodiscard]] bool motion_waits() const noexcept;
  void hand_over(TimePoint now);
  void drop_late(TimePoint now);
  void give_up_late(TimePoint now);
  void give_up_motion(InKernel& entry, TimePoint now) const;
  void give_up_other(InKernel& entry, TimePoint now) const;
  void erase_gone();
  void fail_waiting_commands();

  Link& link_;
  TransmitTimes times_;
  std::vector<Waiting> waiting_;     ///< The next one to go is the last.
  std::vector<InKernel> in_kernel_;  ///< In the order of hand-over.
  std::uint64_t last_id_ = 0;
  std::optional<TimePoint> last_sign_of_life_;
  std::optional<TimePoint> retry_at_;
  Duration retry_pause_ = kRetry;
  bool up_ = false;
};

}  // namespace canopen
