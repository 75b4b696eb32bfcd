#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "canopen/clock.h"
#include "canopen/cob_id.h"
#include "canopen/nmt.h"
#include "canopen/wake_up.h"

namespace canopen {

/// A message on 0x700 + node id: boot-up, heartbeat or guarding answer (CiA 301 §7.2.8.3).
struct HeartbeatMessage {
  bool boot_up = false;                ///< The byte 0x00, which is no state.
  NmtState state = NmtState::unknown;  ///< `unknown` too for numbers that CiA 301 does not define.

  friend bool operator==(const HeartbeatMessage&, const HeartbeatMessage&) = default;
};

/// Guarding answers toggle bit 7, heartbeats keep it 0; the state is in the other seven. Nothing for an empty frame.
[[nodiscard]] std::optional<HeartbeatMessage> decode_heartbeat(std::span<const std::uint8_t> bytes) noexcept;

/// Watches over a node's heartbeat: tells once when it was silent for too long. A message costs no timer.
class HeartbeatConsumer {
 public:
  /// Bus::may_still_hear.
  using MayStillHear = std::function<bool(TimePoint until)>;

  /// `timeout` zero: never silent. `on_silence` may call watch(). Silence is told only where nothing that was received
  /// in time may still be delivered.
  HeartbeatConsumer(const boost::asio::any_io_executor& executor, Duration timeout, std::function<void()> on_silence,
                    MayStillHear may_still_hear);

  /// Silence counts from `from` on, whatever was before, and is told after the timeout, or `at_least` where that is
  /// longer.
  void watch(TimePoint from, Duration at_least = {});
  /// Ends the watch until the next watch().
  void suspend();
  /// A message came.
  void alive(TimePoint at) noexcept;
  /// Frames were lost up to now, a message may have been among them: silence counts from now on. Where more are lost
  /// again and again, it is told at the latest two timeouts after the first loss that no message followed.
  void frames_lost(TimePoint now) noexcept;
  [[nodiscard]] bool watching() const noexcept { return watching_; }

 private:
  void look();

  Duration timeout_;
  Duration limit_;  ///< Of the present watch.
  std::function<void()> on_silence_;
  MayStillHear may_still_hear_;
  TimePoint last_{};                     ///< Silence counts from then on.
  std::optional<TimePoint> first_loss_;  ///< Since the last message.
  bool watching_ = false;
  WakeUp wake_up_;
};

}  // namespace canopen
