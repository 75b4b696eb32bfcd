#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "canopen/clock.h"
#include "canopen/nmt.h"

namespace canopen {

enum class Doubled : std::uint8_t { no, hint, proof };

/// Whether messages come at twice their rate: 16 of them in little more than half the time that 15 periods take. Jitter
/// and a short burst are none. A plain value.
class RateCheck {
 public:
  /// Zero: the period is not known, and nothing is told.
  void set_period(Duration period) noexcept;
  /// True where this one is too early for one sender.
  bool hear(TimePoint at) noexcept;
  void begin_anew() noexcept { count_ = 0; }

 private:
  static constexpr std::size_t kIntervals = 15;
  Duration period_{};
  std::array<TimePoint, kIntervals + 1> times_{};
  std::size_t count_ = 0;  ///< Since the beginning; the newest kIntervals + 1 are kept.
};

/// Looks for a second node under one node id, by what is heard of it. Proof and hint are told for as long as signs
/// come, and a minute longer. A plain value: its owner tells the time.
class DoubledId {
 public:
  static constexpr Duration kForgotten = std::chrono::minutes(1);

  /// `period`: of its heartbeat as it should be; zero: none, and nothing is concluded from states and boot-ups.
  /// `self_starting`: it may go operational again by itself, so going there and back is a hint only.
  explicit DoubledId(Duration period, bool self_starting = false) noexcept
      : period_(period), self_starting_(self_starting) {}

  /// The period that it was read to have; zero: not known, and the rate of its heartbeats tells nothing.
  void set_rate(Duration period) noexcept { rate_.set_period(period); }

  void on_heartbeat(NmtState state, TimePoint at);
  void on_boot_up(TimePoint at);
  /// An NMT command to it or to all left or was heard: what its state does next is no sign, nor, of a reset, a boot-up.
  void on_nmt(NmtCommand command, TimePoint at);
  /// Another SDO answer to a request that had its answer already. The owner sees to it that nobody else had asked.
  /// `different`: of an object that never changes it says something else. Any other is a sign only where another one
  /// follows within a minute: CAN itself may double a frame whose last bit is disturbed, a request too.
  void on_second_answer(bool different, TimePoint at);
  /// A TPDO that follows the SYNC came at twice its rate.
  void on_doubled_tpdo(std::uint16_t number, TimePoint at);
  /// Nothing of what was found so far counts any more.
  void end() noexcept;
  /// Frames may be missing: what comes is not compared with what was heard before.
  void on_frames_lost() noexcept;

  /// Forgets what is too old.
  void look(TimePoint now);
  [[nodiscard]] Doubled verdict() const noexcept;
  /// By what it is known; empty where nothing is.
  [[nodiscard]] const std::string& text() const noexcept;
  /// When look() may change something; kNever: by itself nothing does.
  [[nodiscard]] TimePoint next() const noexcept;

 private:
  struct Sign {
    TimePoint last{};
    std::string text;
  };
  struct State {
    NmtState state{};
    TimePoint at{};
  };
  void prove(TimePoint at, std::string text);
  /// Keeps a proof alive, too.
  void hint(TimePoint at, std::string text);
  [[nodiscard]] bool commanded_since(TimePoint from) const noexcept { return nmt_at_ && *nmt_at_ >= from; }

  Duration period_;
  bool self_starting_;
  RateCheck rate_;
  std::array<std::optional<State>, 2> before_{};  ///< The states before the newest one, newest first.
  std::optional<TimePoint> boot_up_at_;
  std::optional<TimePoint> further_answer_at_;
  std::optional<TimePoint> nmt_at_;    ///< Of the newest NMT command.
  std::optional<TimePoint> reset_at_;  ///< Of the newest that ends in a boot-up.
  std::optional<Sign> proof_;
  std::optional<Sign> hint_;
};

}  // namespace canopen
