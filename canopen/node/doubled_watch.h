#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "canopen/bus/subscription.h"
#include "canopen/node/doubled_id.h"
#include "canopen/node/node_settings.h"
#include "canopen/wake_up.h"

namespace canopen {

class Bus;
struct Received;

/// Listens for a second node under one node id: heartbeats, boot-ups, NMT commands of others, TPDOs that follow the
/// SYNC. What of it the node's own procedures know they tell it.
class DoubledWatch {
 public:
  /// `bus` outlives it; `on_change` is called from the loop when verdict() or text() became another one.
  DoubledWatch(const boost::asio::any_io_executor& executor, Bus& bus, const NodeSettings& settings,
               std::function<void()> on_change);
  DoubledWatch(const DoubledWatch&) = delete;
  DoubledWatch& operator=(const DoubledWatch&) = delete;
  ~DoubledWatch() = default;

  void start();
  void stop();

  /// Of the heartbeat, once it was read or written; zero: not known.
  void set_period(Duration period) noexcept { id_.set_period(period); }
  /// A command of ours is about to leave, or has left.
  void on_nmt(NmtCommand command);
  void on_second_answer(bool different);
  /// Somebody had it started, and wants to see what is left of it.
  void end();

  [[nodiscard]] Doubled verdict() const noexcept { return id_.verdict(); }
  [[nodiscard]] const std::string& text() const noexcept { return id_.text(); }

 private:
  struct SyncTpdo {
    std::uint16_t number = 0;
    RateCheck rate{};
  };
  void on_error_control(const Received& received);
  void on_foreign_nmt(const Received& received);
  /// Tells what changed, and sees to it that what is too old goes.
  void service();

  Bus& bus_;
  const NodeSettings& settings_;
  std::function<void()> on_change_;
  DoubledId id_;
  Doubled told_ = Doubled::no;
  std::vector<SyncTpdo> tpdos_;
  WakeUp timer_;
  std::vector<Subscription> subscriptions_;
};

}  // namespace canopen
