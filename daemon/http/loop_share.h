#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>

#include "canopen/clock.h"

namespace gateway::http {

/// Leaves the loop to the buses: however many clients ask for however much, reading requests and wording answers takes
/// a quarter of its time at most. One has its turn at a time, for a piece of work; the addresses they come from have
/// theirs in rotation, so that one with many clients does not keep those of another waiting.
class LoopShare {
 public:
  /// `wake` is what the client waits with, until it leaves. One that must wait does so until when() it says, and asks
  /// again then, and when its wait is cancelled.
  void enter(canopen::Timer& wake, const boost::asio::ip::address& from);
  /// When this one has its turn; in the past: now.
  [[nodiscard]] canopen::TimePoint when(const canopen::Timer& wake) const noexcept {
    return waiting_.front().wake == &wake ? free_at_ : canopen::kNever;
  }
  /// It had its turn, or wants none any more.
  void leave(const canopen::Timer& wake);
  /// A piece of work was done.
  void note(canopen::TimePoint begin, canopen::TimePoint end) noexcept { free_at_ = end + 3 * (end - begin); }

 private:
  struct Waiter {
    canopen::Timer* wake;
    std::uint64_t round;  ///< Each has a client of each address once.
  };

  std::deque<Waiter> waiting_;                              ///< By round, then as they came.
  std::uint64_t round_ = 0;                                 ///< Of the newest turn.
  std::map<boost::asio::ip::address, std::uint64_t> next_;  ///< Round of an address' next client; missing: `round_`.
  canopen::TimePoint free_at_{};
};

}  // namespace gateway::http
