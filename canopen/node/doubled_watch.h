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
struct HeartbeatMessage;
struct Received;

/// Looks for a second node under one node id: it listens for NMT commands of others and for TPDOs that follow the SYNC.
/// What of it the node's own procedures know they tell it.
class DoubledWatch {
 public:
  /// `bus` and `settings` outlive it. `is_sure` tells whether the node is served, and this TPDO's type was read or
  /// written. `on_change` is called from the loop when verdict() or text() became another one.
  DoubledWatch(const boost::asio::any_io_executor& executor, Bus& bus, const NodeSettings& settings,
               std::function<bool(std::uint16_t tpdo)> is_sure, std::function<void()> on_change);
  DoubledWatch(const DoubledWatch&) = delete;
  DoubledWatch& operator=(const DoubledWatch&) = delete;
  ~DoubledWatch() = default;

  void start();
  void stop();

  /// Whether the period of the heartbeat was read to be as it should be.
  void set_rate_known(bool known) noexcept {
    id_.set_rate(known ? settings_.error_control.heartbeat : Duration::zero());
  }
  /// A boot-up, a heartbeat or an answer to guarding.
  void on_error_control(const HeartbeatMessage& message, TimePoint at);
  /// A command of ours is about to leave, or has left.
  void on_nmt(NmtCommand command);
  void on_second_answer(bool different);
  /// Nothing of what was found so far counts any more.
  void end();

  [[nodiscard]] Doubled verdict() const noexcept { return id_.verdict(); }
  [[nodiscard]] const std::string& text() const noexcept { return id_.text(); }

 private:
  struct SyncTpdo {
    std::uint16_t number = 0;
    RateCheck rate{};
  };
  void on_foreign_nmt(const Received& received);
  void on_sync_tpdo(SyncTpdo& tpdo, const Received& received);
  void on_frames_lost();
  /// Tells what changed, and sees to it that what is too old goes.
  void service();

  Bus& bus_;
  const NodeSettings& settings_;
  std::function<bool(std::uint16_t)> is_sure_;
  std::function<void()> on_change_;
  DoubledId id_;
  Doubled told_ = Doubled::no;
  std::vector<SyncTpdo> tpdos_;
  std::optional<TimePoint> foreign_sync_at_;
  WakeUp timer_;
  std::vector<Subscription> subscriptions_;
};

}  // namespace canopen
