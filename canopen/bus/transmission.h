#pragma once

#include <boost/asio/awaitable.hpp>
#include <functional>
#include <optional>

#include "canopen/bus/bus.h"
#include "canopen/bus/ticket.h"
#include "canopen/clock.h"
#include "canopen/error.h"

namespace canopen {

/// A command on its way, and the wait for its departure (echo). Lives in the coroutine that waits, which may be ended
/// by others through withdraw(); when it goes, a command that still waits is withdrawn.
class Transmission {
 public:
  /// `transmit_class`: stop, nmt or command. `bus` outlives the transmission. `on_left` is called when its echo comes,
  /// before result() returns: an answer may follow in the same batch. Like Ticket::Told it must not call the bus.
  Transmission(Bus& bus, TransmitClass transmit_class, const Frame& frame, TimePoint deadline,
               std::function<void()> on_left = {});
  ~Transmission();
  Transmission(const Transmission&) = delete;
  Transmission& operator=(const Transmission&) = delete;

  /// Not handed over by the deadline, or withdrawn: `timeout`. Handed over without an echo by the deadline or in time
  /// (TransmitTimes::echo): `timeout` with outcome_unknown, and the bus takes no command until an echo returns.
  /// `offline` while the bus is down or, a stop excepted, takes none. To be awaited once.
  boost::asio::awaitable<Result<void>> result();
  /// Not handed over yet, it never leaves; else nothing changes.
  void withdraw() { ticket_.withdraw(); }

 private:
  Bus& bus_;
  Timer timer_;
  std::optional<Departure> departure_;
  Ticket ticket_;
};

/// How a departure reads as the answer to a command.
[[nodiscard]] Result<void> result_of(Departure departure);

}  // namespace canopen
