#pragma once

#include <chrono>
#include <optional>

namespace mqtt {

/// Whether a broker lives to whom nothing is published: where nothing came of it for the quiet time it is asked
/// something that costs nothing and that every broker has to answer. Paho's own ping takes 2.5 periods of keep alive,
/// which may not be short, for the broker goes by it too. Knows no time but what it is given. Not thread-safe.
class Pulse {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// `quiet`: nothing came of it for so long.
  explicit Pulse(std::chrono::milliseconds quiet) noexcept : quiet_(quiet) {}

  /// It said something; a connection begins with that.
  void heard(TimePoint now) noexcept {
    heard_ = now;
    asked_.reset();
  }
  /// It is to be asked.
  [[nodiscard]] bool wants(TimePoint now) const noexcept { return !asked_ && now - heard_ >= quiet_; }
  void asked(TimePoint now) noexcept { asked_ = now; }
  /// It was asked, and has said nothing for so long.
  [[nodiscard]] bool stopped(std::chrono::milliseconds patience, TimePoint now) const noexcept {
    return asked_ && now - *asked_ >= patience;
  }
  /// When wants() or stopped() becomes true if it says nothing until then.
  [[nodiscard]] TimePoint due(std::chrono::milliseconds patience) const noexcept {
    return asked_ ? *asked_ + patience : heard_ + quiet_;
  }
  [[nodiscard]] bool is_asked() const noexcept { return asked_.has_value(); }

 private:
  std::chrono::milliseconds quiet_;
  TimePoint heard_{};
  std::optional<TimePoint> asked_;
};

}  // namespace mqtt
