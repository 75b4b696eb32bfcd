#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

#include "canopen/bus/link.h"
#include "canopen/frame.h"
#include "simulator/alarm.h"

namespace simulator {

/// What is plugged into a Network: a simulated drive.
class Station {
 public:
  /// A frame of somebody else on the bus, or of a drive on the same link.
  virtual void on_frame(const canopen::Frame& frame) = 0;
  /// The bus works again after it was down.
  virtual void on_bus_up() = 0;
  /// Every Network::kTick; `passed` is the true time since the last one.
  virtual void on_tick(canopen::Duration passed) = 0;

 protected:
  ~Station() = default;
};

/// One link shared by any number of simulated drives. Frames a busy link refuses wait in a bounded queue and leave in
/// order. One loop, one thread. Outlives its stations.
class Network final : public canopen::LinkEvents {
 public:
  Network(boost::asio::any_io_executor executor, std::unique_ptr<canopen::Link> link);
  ~Network();
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  void open();   ///< Starts receiving; may be called again after close().
  void close();  ///< Stops receiving and forgets waiting frames.

  /// False when the frame is lost: the bus is down, the queue is full or the network is closed.
  bool send(const canopen::Frame& frame);

  void attach(Station& station);
  void detach(Station& station);

  [[nodiscard]] boost::asio::any_io_executor executor() const { return executor_; }
  [[nodiscard]] std::uint64_t frames_lost() const noexcept { return lost_; }
  [[nodiscard]] std::size_t frames_waiting() const noexcept { return waiting_.size(); }

  static constexpr std::size_t kCapacity = 512;  ///< Frames waiting for a busy link.
  static constexpr canopen::Duration kTick = std::chrono::milliseconds(10);
  static constexpr canopen::Duration kRetry = std::chrono::milliseconds(1);

  void on_frames(std::span<const canopen::Received> frames) override;
  void on_echo(const canopen::Received& sent) override;
  void on_bus_state(const canopen::BusState& state) override;
  void on_frames_lost(std::uint32_t count) override;

 private:
  void hand_out(const canopen::Frame& frame);
  void flush();
  void tick();

  boost::asio::any_io_executor executor_;
  std::unique_ptr<canopen::Link> link_;
  std::vector<Station*> stations_;
  std::deque<canopen::Frame> waiting_;
  Alarm retry_;
  Alarm tick_;
  canopen::TimePoint last_tick_;
  std::uint64_t lost_ = 0;
  bool open_ = false;
  bool up_ = false;
};

}  // namespace simulator
