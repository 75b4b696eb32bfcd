#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "bridges/mqtt/message.h"
#include "bridges/mqtt/notice.h"
#include "canopen/clock.h"

namespace mqtt {

/// Counts what was put right since the start, and says so at most once each kPause.
class PutRightTally {
 public:
  static constexpr canopen::Duration kPause = std::chrono::minutes(1);

  /// This leaves now.
  void note(const std::vector<Message>& batch, canopen::TimePoint now, const Notice& notice);
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  std::uint64_t count_ = 0;
  std::optional<canopen::TimePoint> said_;
};

}  // namespace mqtt
