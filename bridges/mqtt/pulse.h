#pragma once

#include <chrono>
#include <optional>

namespace mqtt {

/// Whether a broker lives to whom nothing is published: where nothing came of it for kQuiet it is asked something that
/// costs nothing and that every broker has to answer. Paho's own ping takes 2.5 periods of keep alive, which may not be
/// short, for the broker goes by it too. Knows no time but what it is given. Not thread-safe.
class Pulse {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kQuiet{2};

  /// It said something; a connection begins with that.
  void heard(TimePoint now) noexcept {
    heard_ = now;
    asked_.reset();
  }
  /// It is to be asked.
  [[nodiscard]] bool wants(TimePoint now) const noexcept { return !asked_ && now - heard_ >= kQuiet; }
  void asked(TimePoint now) noexcept { asked_ = now; }
  /// It was asked, and has said nothing for so long.
  [[nodiscard]] bool stopped(std::chrono::milliseconds patience, TimePoint now) const noexcept {
    return asked_ && now - *asked_ > patience;
  }

 private:
  TimePoint heard_{};
  std::optional<TimePoint> asked_;
};

}  // namespace mqtt
