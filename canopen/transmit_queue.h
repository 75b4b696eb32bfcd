#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "canopen/clock.h"
#include "canopen/frame.h"
#include "canopen/link.h"

namespace canopen {

/// How the wait for a command's departure ended.
enum class Departure : std::uint8_t {
  left,       ///< Its echo came back.
  withdrawn,  ///< Its deadline passed before the kernel had it: it can never leave.
  unknown,    ///< The kernel had it, and no echo came in time.
  offline     ///< The bus is down, or takes no command until an echo returns.
};

/// Everything that waits to leave on one bus, by COB-ID priority. The kernel gets only a few frames at a time, the next
/// one when an echo came back: so a frame past its time is dropped here instead of leaving when a cable is plugged in
/// an hour later. Of commands the kernel holds at most one, and gets it only while the bus shows life.
///
/// Has no timer of its own: the owner calls service() at next_time() and after each event.
class TransmitQueue {
 public:
  /// Called once, possibly from inside push_command(); must not call the queue.
  using Completion = std::function<void(Departure)>;
  using Ticket = std::uint64_t;

  static constexpr std::size_t kCapacity = 1024;
  static constexpr std::size_t kMaxInKernel = 4;
  static constexpr Duration kEchoTime = std::chrono::milliseconds(100);  ///< A command without echo is unknown then.
  static constexpr Duration kLifeTime = std::chrono::seconds(1);         ///< Of a frame that is no command.
  static constexpr Duration kSignOfLife = std::chrono::seconds(1);  ///< Commands go while the last sign is not older.
  static constexpr Duration kRetry = std::chrono::milliseconds(2);  ///< After `busy`, where no echo comes first.

  explicit TransmitQueue(Link& link);

  /// False where the bus is down or the queue is full.
  bool push(const Frame& frame, TimePoint now);
  /// Replaces a waiting frame of the same COB-ID that was pushed this way. False too while a command of that COB-ID
  /// waits or is in the kernel.
  bool push_latest(const Frame& frame, TimePoint now);
  /// The same for a command that is repeated: like a command it goes only while the bus shows life, or repetitions
  /// would gather in the kernel and leave when a cable is plugged in again.
  bool push_repetition(const Frame& frame, TimePoint now);
  /// Takes the place of a waiting latest frame or repetition of its COB-ID, which is older.
  Ticket push_command(const Frame& frame, TimePoint deadline, Completion completion, TimePoint now);
  /// Nobody waits any more: withdraws it where it still waits here. Its completion is not called.
  void cancel(Ticket ticket);
  /// Withdraws the commands and the latest frame or repetition of a COB-ID that still wait here.
  void withdraw(std::uint32_t cob_id);

  void on_echo(const Frame& frame, TimePoint at);
  void on_received(TimePoint at) noexcept { last_sign_of_life_ = at; }
  /// The bus came up or went down. What waits is dropped when it goes down, commands are answered.
  void on_bus(bool up);

  /// Drops and answers what is past its time, and hands over what may go.
  void service(TimePoint now);
  [[nodiscard]] std::optional<TimePoint> next_time() const noexcept;
  [[nodiscard]] bool idle() const noexcept { return waiting_.empty(); }
  /// Commands or repetitions wait for a sign of life, and no frame of ours waits or is under way that could bring one.
  [[nodiscard]] bool wants_sign_of_life(TimePoint now) const noexcept;

 private:
  enum class Kind : std::uint8_t { ordinary, latest, repetition, command };
  struct Waiting {
    Frame frame;
    Kind kind;
    TimePoint until;
    Ticket ticket;
    Completion completion;
  };
  struct InKernel {
    Frame frame;
    Kind kind;
    TimePoint since;
    TimePoint until;  ///< Commands: unknown then; others: no longer counted.
    Ticket ticket;
    Completion completion;
    bool passed = false;               ///< A frame handed over later has come back before it.
    bool overdue = false;              ///< A command that the controller may still hold: none other is taken.
    bool gone = false;                 ///< Its echo came, or is not waited for any more.
    std::optional<TimePoint> lost_at;  ///< Overdue, and the bus moves again: its echo comes by then or never.
  };

  bool replace_or_enqueue(const Frame& frame, Kind kind, TimePoint now);
  bool enqueue(Waiting entry);
  [[nodiscard]] bool holds_command(std::uint32_t cob_id) const noexcept;
  [[nodiscard]] bool refuses_commands() const noexcept;
  [[nodiscard]] bool alive(TimePoint now) const noexcept;
  [[nodiscard]] bool may_go(const Waiting& entry, TimePoint now) const noexcept;
  void hand_over(TimePoint now);
  void drop_late(TimePoint now);
  void give_up_late(TimePoint now);
  static void give_up(InKernel& entry, TimePoint now);
  void erase_gone();
  void fail_waiting_commands();

  Link& link_;
  std::vector<Waiting> waiting_;     ///< The next one to go is the last.
  std::vector<InKernel> in_kernel_;  ///< In the order of hand-over.
  Ticket last_ticket_ = 0;
  std::optional<TimePoint> last_sign_of_life_;
  std::optional<TimePoint> retry_at_;
  bool up_ = false;
};

}  // namespace canopen
