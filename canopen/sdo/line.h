#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "canopen/clock.h"
#include "canopen/event.h"

namespace canopen {

/// The line of those who want an SDO channel. The first one has it; commands go before everything else that waits.
class SdoLine {
 public:
  enum class Kind : std::uint8_t { transfer, command };
  enum class Verdict : std::uint8_t {
    mine,         ///< The channel may be used.
    late,         ///< The deadline passed first.
    interrupted,  ///< Everything was called off.
    withdrawn     ///< The commands were.
  };
  class Place;

  explicit SdoLine(boost::asio::any_io_executor executor);
  ~SdoLine() = default;
  SdoLine(const SdoLine&) = delete;
  SdoLine& operator=(const SdoLine&) = delete;

  /// Calls off everybody who is in the line now.
  void interrupt();
  /// Calls off the commands that are in the line now.
  void withdraw_commands();
  [[nodiscard]] std::uint64_t interruptions() const noexcept { return interruptions_; }

  [[nodiscard]] bool empty() const noexcept { return places_.empty(); }
  boost::asio::awaitable<void> until_empty();

 private:
  void insert(Place* place);

  std::deque<Place*> places_;
  Event moved_;  ///< Somebody left, gave way, or was called off.
  std::uint64_t interruptions_ = 0;
  std::uint64_t withdrawals_ = 0;
};

/// A place in the line, as long as it lives.
class SdoLine::Place {
 public:
  Place(SdoLine& line, Kind kind);
  ~Place();
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  boost::asio::awaitable<Verdict> wait_until(TimePoint deadline);
  /// Lets the commands that wait go first, before the others; true where there were any: then it is to wait again.
  bool give_way();
  /// `mine` where it was not called off.
  [[nodiscard]] Verdict verdict() const noexcept;

 private:
  friend class SdoLine;
  SdoLine& line_;
  Kind kind_;
  std::uint64_t interruptions_;
  std::uint64_t withdrawals_;
};

}  // namespace canopen
