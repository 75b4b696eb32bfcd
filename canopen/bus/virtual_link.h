#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "canopen/bus/link.h"
#include "canopen/wake_up.h"

namespace canopen {

class VirtualLink;

/// An in-process CAN bus: every frame one link sends reaches all others and comes back to the sender as its echo.
/// Delivery runs through the loop, never inside send(). Outlives its links.
///
/// Without a bit rate frames take no time and arrive in the order in which they were sent. With one the bus carries one
/// frame at a time: each link has a first-in-first-out queue, as a controller with one mailbox behind a kernel queue
/// has; whenever the bus gets free, the lowest identifier among the first frames of all links goes (ISO 11898-1), and
/// it is received and echoed when its last bit has passed (bits_on_wire()). Equal identifiers of two links, an error on
/// a real bus, go in the order in which the links were plugged in.
///
/// The queue of the bus, or of each link, is bounded; a full one answers `busy`.
class VirtualBus {
 public:
  /// `bitrate` in bit/s, above 0; nothing: frames take no time.
  explicit VirtualBus(boost::asio::any_io_executor executor, std::optional<std::uint32_t> bitrate = std::nullopt);
  ~VirtualBus();
  VirtualBus(const VirtualBus&) = delete;
  VirtualBus& operator=(const VirtualBus&) = delete;

  [[nodiscard]] std::unique_ptr<Link> connect();

  /// Tests: a bus that is off or down accepts nothing and tells every link so.
  void set_state(const BusState& state);
  /// Tests: while true, frames are delivered to the others but not echoed to the sender.
  void withhold_echoes(bool withhold) noexcept { withhold_echoes_ = withhold; }

  /// With a bit rate: when the frame on the bus will have passed. Nothing while none is. A test that moves time by hand
  /// stops at these moments: a frame begins when the loop learns that the one before has passed.
  [[nodiscard]] std::optional<TimePoint> next_departure() const noexcept;

  static constexpr std::size_t kCapacity = 1024;  ///< Frames waiting in a queue.

 private:
  friend class VirtualLink;
  struct Pending {
    const VirtualLink* sender = nullptr;
    Frame frame;
  };

  SendResult accept(VirtualLink& sender, const Frame& frame);
  void schedule();
  void deliver();
  void begin_frame();
  void end_frame();
  void deliver_one(const Pending& pending);
  void tell_state(VirtualLink& link);
  void remove(const VirtualLink& link);

  /// What happens on a bus with a bit rate.
  struct Wire {
    Wire(VirtualBus& bus, std::uint32_t bits_per_second);
    std::uint32_t bitrate;
    WakeUp end_of_frame;
    std::optional<Pending> frame;  ///< On the bus now.
    TimePoint departure{};         ///< Of that one.
  };

  boost::asio::any_io_executor executor_;
  std::optional<Wire> wire_;         ///< Nothing: frames take no time.
  std::vector<VirtualLink*> links_;  ///< Nothing in a place: unplugged during a delivery.
  std::deque<Pending> queue_;        ///< Of a bus without a bit rate.
  BusState state_{BusCondition::error_active, 0, 0};
  bool scheduled_ = false;
  bool delivering_ = false;
  bool withhold_echoes_ = false;
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);  ///< Tells posted work that the bus is gone.
};

}  // namespace canopen
