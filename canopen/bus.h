#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "canopen/bus_state.h"
#include "canopen/error.h"
#include "canopen/link.h"
#include "canopen/subscription.h"

namespace canopen {

struct BusSettings {
  std::optional<std::uint32_t> bitrate{};               ///< bit/s, for the load; nothing: no load shown.
  std::uint8_t node_id = 127;                           ///< Our own; 0: none, no heartbeat.
  Duration heartbeat = std::chrono::milliseconds(500);  ///< Zero: none.
  Duration sync{};                                      ///< Zero: no SYNC.
  friend bool operator==(const BusSettings&, const BusSettings&) = default;
};

/// One CAN bus: owns the link and the transmit queue, dispatches received frames by COB-ID (2 048 slots), produces our
/// heartbeat and SYNC. Every frame of the gateway passes its transmit queue.
class Bus {
 public:
  using FrameHandler = std::function<void(const Received&)>;
  using StateHandler = std::function<void(const BusState&)>;
  using LossHandler = std::function<void(std::uint32_t)>;

  Bus(boost::asio::any_io_executor executor, std::unique_ptr<Link> link, BusSettings settings);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  void start();
  /// Ends heartbeat, SYNC and transmission; what waits is dropped and answered `offline`.
  boost::asio::awaitable<void> stop();

  /// Handlers may subscribe and unsubscribe while one runs; one that was added then is first called for the next event.
  /// The bus outlives its subscriptions.
  [[nodiscard]] Subscription subscribe(std::uint32_t cob_id, FrameHandler handler);
  [[nodiscard]] Subscription subscribe_state(StateHandler handler);
  [[nodiscard]] Subscription subscribe_losses(LossHandler handler);

  /// Queues a frame that is no command (SDO reads and boot writes, guarding requests). Dropped when it could not leave
  /// within a second, or while the bus is down: then false.
  bool send(const Frame& frame);
  /// The same for a repeated RPDO, of which only the newest matters: it replaces one of its COB-ID that still waits.
  /// Refused (false) while a command of its COB-ID waits or is leaving, which is always newer. It goes only where a
  /// frame was received or echoed within the last second.
  bool repeat(const Frame& frame);
  /// Queues a command and waits for its departure (echo). Withdrawn when not handed over by `deadline`: `timeout`.
  /// Handed over without an echo by `deadline` or in 100 ms: `timeout` with outcome_unknown, and the bus takes no
  /// command until an echo returns. `offline` while the bus is down or takes none. It is handed over only where a frame
  /// was received or echoed within the last second; on a silent bus our heartbeat goes first to find out. So without a
  /// heartbeat of ours a command on a silent bus ends as `timeout`, not sent.
  boost::asio::awaitable<Result<void>> send_command(Frame frame, TimePoint deadline);
  /// Withdraws what has not been handed over yet of a COB-ID: commands (their answer is `timeout`) and a frame of
  /// repeat().
  void withdraw(std::uint32_t cob_id);

  /// Every frame that was received before this moment has been delivered (Link::heard_until).
  [[nodiscard]] TimePoint heard_until() const;
  /// A frame that was received before `until` may still be delivered: silence until then is not certain yet. While the
  /// loop lags behind this outlasts `until`; wait with or_soon().
  [[nodiscard]] bool may_still_hear(TimePoint until) const { return Clock::now() < until || heard_until() < until; }

  [[nodiscard]] const BusState& state() const noexcept;
  [[nodiscard]] const BusStatistics& statistics() const noexcept;
  [[nodiscard]] const BusSettings& settings() const noexcept;

 private:
  class Core;
  std::unique_ptr<Core> core_;
};

}  // namespace canopen
