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

  /// Of its heartbeat, as it was read or written. Zero: not known, and nothing is concluded from times.
  void set_period(Duration period) noexcept;

  void on_heartbeat(NmtState state, TimePoint at);
  void on_boot_up(TimePoint at);
  /// An NMT command to it or to all left or was heard: what its state does next is no sign, nor, of a reset, a boot-up.
  void on_nmt(NmtCommand command, TimePoint at);
  /// Another SDO answer to a request that had its answer already; `different`: it says something else. The owner sees
  /// to it that nobody else had asked. One that says the same is a sign only where another one follows within a minute:
  /// CAN itself may double a frame whose last bit is disturbed.
  void on_second_answer(bool different, TimePoint at);
  /// A TPDO that follows the SYNC came at twice its rate.
  void on_doubled_tpdo(std::uint16_t number, TimePoint at);
  /// Nothing of what was heard so far counts any more.
  void end() noexcept;

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
  static void note(std::optional<Sign>& sign, TimePoint at, std::string text);
  [[nodiscard]] bool commanded_since(TimePoint from) const noexcept { return nmt_at_ && *nmt_at_ >= from; }

  Duration period_{};
  RateCheck rate_;
  std::array<std::optional<State>, 2> before_{};  ///< The states before the newest one, newest first.
  std::optional<TimePoint> boot_up_at_;
  std::optional<TimePoint> same_answer_at_;
  std::optional<TimePoint> nmt_at_;    ///< Of the newest NMT command.
  std::optional<TimePoint> reset_at_;  ///< Of the newest that ends in a boot-up.
  std::optional<Sign> proof_;
  std::optional<Sign> hint_;
};

}  // namespace canopen
