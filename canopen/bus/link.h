#pragma once

#include <cstdint>
#include <span>

#include "canopen/bus/bit_timing.h"
#include "canopen/bus/bus_state.h"
#include "canopen/clock.h"
#include "canopen/frame.h"

namespace canopen {

/// A frame with the moment it was received.
struct Received {
  Frame frame;
  TimePoint at;   ///< When it was received, not when it was read; never before that of an earlier frame.
  WallTime wall;  ///< The kernel's receive stamp.
};

/// What an error frame of the driver tells beside a state.
enum class ErrorSign : std::uint8_t {
  other,
  not_acknowledged  ///< Nobody acknowledged a frame of ours.
};

/// What a link tells its owner. Called from the loop only, never from inside Link::send().
class LinkEvents {
 public:
  /// Frames of other nodes, in order of reception. Error frames are not among them (see on_bus_state).
  virtual void on_frames(std::span<const Received> frames) = 0;
  /// Our own frame came back: it has left on the bus (an interface without IFF_ECHO echoes on hand-over), then.
  virtual void on_echo(const Received& sent) = 0;
  /// Frames and echoes that come while the bus is not up are from before, and to be ignored.
  virtual void on_bus_state(const BusState& state) = 0;
  /// `count` received frames were dropped before we read them (SO_RXQ_OVFL).
  virtual void on_frames_lost(std::uint32_t count) = 0;
  /// The driver told of an error: a change of the error state, an overrun, a bus-off or the end of one, a frame that
  /// nobody acknowledged.
  virtual void on_error_frame(const Received& /*error*/, ErrorSign /*sign*/) {}
  /// What the controller is set up with: when it is first known, and when it changed.
  virtual void on_bit_timing(const BitTiming& /*timing*/) {}

 protected:
  ~LinkEvents() = default;
};

enum class SendResult : std::uint8_t {
  handed_over,  ///< The kernel or the in-process bus has it; its echo confirms the departure.
  busy,         ///< No room now (EAGAIN, ENOBUFS): try again after an echo or a short pause.
  down          ///< No interface, or it is down.
};

/// The seam to a CAN bus. One owner, one thread, non-blocking.
class Link {
 public:
  virtual ~Link() = default;
  Link() = default;
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Starts receiving. A missing interface is no failure: the link reports BusCondition::down and keeps looking.
  /// `events` outlives the link or its close().
  virtual void open(LinkEvents& events) = 0;
  /// No event is delivered once this returns.
  virtual void close() = 0;
  [[nodiscard]] virtual SendResult send(const Frame& frame) = 0;
  /// Every frame that was received before this moment has been delivered. After a stall of the process it lies behind
  /// until what waited was read: who decides on silence asks this clock. May cost system calls.
  [[nodiscard]] virtual TimePoint heard_until() { return Clock::now(); }
  /// An echo tells that another node acknowledged the frame; else only that kernel or adapter have taken it.
  [[nodiscard]] virtual bool echoes_prove_departure() const noexcept { return true; }
};

}  // namespace canopen
