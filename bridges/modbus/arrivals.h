#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "canopen/clock.h"

namespace modbus {

/// When the bytes of a connection came, as far as that can be told. A connection is served one request at a time, so
/// what it sends meanwhile is read later than it came; what is older than a stop must be known all the same. Positions
/// count the bytes since the connection began.
class Arrivals {
 public:
  struct Between {
    canopen::TimePoint earliest;
    canopen::TimePoint latest;
  };

  explicit Arrivals(canopen::TimePoint begin) : looked_(begin) {}

  /// At `now` everything before `position` is there: what was not there when last looked came in between.
  void on_look(std::uint64_t position, canopen::TimePoint now);
  /// Nothing had been there, and it was waited for: what is new came at `now`.
  void on_awaited(std::uint64_t position, canopen::TimePoint now);
  /// Of the byte before `position`, which was looked at and is not forgotten.
  [[nodiscard]] Between of(std::uint64_t position) const;
  /// All before `position` was served, reads as well as writes: what is not forgotten takes room, and where there is
  /// none what comes later counts as older than it is.
  void forget(std::uint64_t position);

 private:
  struct Part {
    std::uint64_t end = 0;
    Between came;
  };
  void add(std::uint64_t end, Between came);
  [[nodiscard]] std::span<const Part> parts() const { return std::span(parts_).first(count_); }

  std::array<Part, 16> parts_{};  ///< Where they do not do, the last one takes in more, and is less sure.
  std::size_t count_ = 0;
  std::uint64_t end_ = 0;
  canopen::TimePoint looked_;
};

}  // namespace modbus
