#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "canopen/bus/bus_load.h"
#include "canopen/bus/bus_state.h"
#include "canopen/bus/cyclic_producer.h"
#include "canopen/bus/dispatch.h"
#include "canopen/bus/error_share.h"
#include "canopen/bus/frame_tap.h"
#include "canopen/bus/handler_list.h"
#include "canopen/bus/link.h"
#include "canopen/bus/subscription.h"
#include "canopen/bus/ticket.h"
#include "canopen/bus/transmit_queue.h"
#include "canopen/bus/transmit_trouble.h"
#include "canopen/sdo/budget.h"
#include "canopen/wake_up.h"

namespace canopen {

struct BusSettings {
  std::optional<std::uint32_t> bitrate{};  ///< bit/s, until the interface tells it; neither: no load, usual times.
  std::uint8_t node_id = 127;              ///< Our own; 0: none, no heartbeat.
  Duration heartbeat = std::chrono::milliseconds(500);  ///< Zero: none.
  Duration sync{};                                      ///< Zero: no SYNC.
  double sdo_load = SdoBudget::kUsualLoad;              ///< See SdoBudget; 0..1. Without a bit rate not used.
  friend bool operator==(const BusSettings&, const BusSettings&) = default;
};

/// One CAN bus: owns the link and the transmit queue, dispatches received frames by COB-ID (2 048 slots), produces our
/// heartbeat and SYNC. Every frame of the gateway passes its transmit queue.
class Bus final : private LinkEvents {
 public:
  using FrameHandler = Dispatch::Handler;
  using StateHandler = std::function<void(const BusState&)>;
  using LossHandler = std::function<void(std::uint32_t)>;
  using TimingHandler = std::function<void(const BitTiming&)>;

  Bus(boost::asio::any_io_executor executor, std::unique_ptr<Link> link, BusSettings settings);
  ~Bus() = default;
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
  [[nodiscard]] Subscription subscribe_timing(TimingHandler handler);
  /// `tap` sees every frame until the subscription ends.
  [[nodiscard]] Subscription add_tap(FrameTap& tap);

  /// Queues a frame that is to be with the kernel before `until`. `told` is called once, possibly from inside, and must
  /// not call the bus. The frame belongs to the ticket, which must go before the bus.
  ///
  /// NMT and commands are refused while the bus is down, or takes none until an echo returns; a stop only while it is
  /// down. They and repetitions are handed over only where a frame was received or echoed within the last second; on a
  /// silent bus our heartbeat goes first to find out. So without a heartbeat of ours a command on a silent bus is never
  /// sent.
  [[nodiscard]] Ticket send(TransmitClass transmit_class, const Frame& frame, TimePoint until, Ticket::Told told = {});

  /// Every frame that was received before this moment has been delivered (Link::heard_until).
  [[nodiscard]] TimePoint heard_until() const { return link_->heard_until(); }
  /// A frame that was received before `until` may still be delivered: silence until then is not certain yet. While the
  /// loop lags behind this outlasts `until`; wait with or_soon().
  [[nodiscard]] bool may_still_hear(TimePoint until) const { return Clock::now() < until || heard_until() < until; }

  [[nodiscard]] SdoBudget& sdo_budget() noexcept { return sdo_budget_; }
  [[nodiscard]] const BusState& state() const noexcept { return state_; }
  [[nodiscard]] const BusStatistics& statistics() noexcept;
  /// For judge_transmission().
  [[nodiscard]] TransmitSigns transmit_signs() const noexcept;
  [[nodiscard]] const BusSettings& settings() const noexcept { return settings_; }
  /// bit/s, by the interface, else by the settings; nothing where neither tells it.
  [[nodiscard]] std::optional<std::uint32_t> bitrate() const noexcept { return bitrate_; }

 private:
  friend class Transmission;

  void on_frames(std::span<const Received> frames) override;
  void on_echo(const Received& sent) override;
  void on_bus_state(const BusState& state) override;
  void on_frames_lost(std::uint32_t count) override;
  void on_error_frame(const Received& error, ErrorSign sign) override;
  void on_bit_timing(const BitTiming& timing) override;

  void come_up();
  void go_down();
  void show_taps(const Received& frame, FrameOrigin origin);
  /// Lets the queue do what is due, and sees to it that this is called again in time.
  void service();
  [[nodiscard]] bool has_heartbeat() const noexcept;
  [[nodiscard]] bool has_sync() const noexcept { return settings_.sync > Duration::zero(); }

  boost::asio::any_io_executor executor_;
  std::unique_ptr<Link> link_;
  BusSettings settings_;
  std::optional<std::uint32_t> bitrate_;
  BusState state_;
  bool told_ = false;  ///< The link said something: an interface that is missing from the start is news, too.
  BusStatistics statistics_;
  BusLoad load_;
  ErrorShare errors_;
  std::optional<TimePoint> ack_error_at_;
  TimePoint silent_since_{};  ///< The newest frame of others, or when the bus came up.
  SdoBudget sdo_budget_;
  Dispatch dispatch_;
  HandlerList<const BusState&> state_handlers_;
  HandlerList<std::uint32_t> loss_handlers_;
  HandlerList<const BitTiming&> timing_handlers_;
  std::vector<FrameTap*> taps_;
  TransmitQueue queue_;
  WakeUp wake_up_;
  Ticket heartbeat_ticket_;
  Ticket sync_ticket_;
  CyclicProducer heartbeat_;
  CyclicProducer sync_;
  std::size_t transmissions_ = 0;  ///< Coroutines that wait for a departure.
};

}  // namespace canopen
