#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <memory>
#include <span>

#include "canopen/bus.h"
#include "canopen/bus_load.h"
#include "canopen/cyclic_producer.h"
#include "canopen/dispatch.h"
#include "canopen/handler_list.h"
#include "canopen/transmit_queue.h"
#include "canopen/wake_up.h"

namespace canopen {

/// What a Bus is made of: the link's events go to the dispatch and the transmit queue, its timer drives the queue.
class Bus::Core final : public LinkEvents {
 public:
  Core(boost::asio::any_io_executor executor, std::unique_ptr<Link> link, BusSettings settings);
  virtual ~Core() = default;
  Core(const Core&) = delete;
  Core& operator=(const Core&) = delete;

  void start();
  boost::asio::awaitable<void> stop();
  bool send(const Frame& frame, bool (TransmitQueue::*push)(const Frame&, TimePoint));
  boost::asio::awaitable<Result<void>> send_command(Frame frame, TimePoint deadline);
  void withdraw(std::uint32_t cob_id) { queue_.withdraw(cob_id); }
  [[nodiscard]] TimePoint heard_until() const { return link_->heard_until(); }
  const BusStatistics& statistics();

  void on_frames(std::span<const Received> frames) override;
  void on_echo(const Frame& frame, TimePoint at) override;
  void on_bus_state(const BusState& state) override;
  void on_frames_lost(std::uint32_t count) override;

  [[nodiscard]] Dispatch& dispatch() noexcept { return dispatch_; }
  [[nodiscard]] HandlerList<const BusState&>& state_handlers() noexcept { return state_handlers_; }
  [[nodiscard]] HandlerList<std::uint32_t>& loss_handlers() noexcept { return loss_handlers_; }
  [[nodiscard]] const BusState& state() const noexcept { return state_; }
  [[nodiscard]] const BusSettings& settings() const noexcept { return settings_; }

 private:
  class PendingCommand;

  void come_up();
  void go_down();
  /// Lets the queue do what is due, and sees to it that this is called again in time.
  void service();
  [[nodiscard]] bool has_heartbeat() const noexcept;
  [[nodiscard]] bool has_sync() const noexcept { return settings_.sync > Duration::zero(); }

  boost::asio::any_io_executor executor_;
  std::unique_ptr<Link> link_;
  BusSettings settings_;
  BusState state_;
  bool told_ = false;  ///< The link said something: an interface that is missing from the start is news, too.
  BusStatistics statistics_;
  BusLoad load_;
  Dispatch dispatch_;
  HandlerList<const BusState&> state_handlers_;
  HandlerList<std::uint32_t> loss_handlers_;
  TransmitQueue queue_;
  WakeUp wake_up_;
  CyclicProducer heartbeat_;
  CyclicProducer sync_;
  std::size_t pending_commands_ = 0;
};

}  // namespace canopen
