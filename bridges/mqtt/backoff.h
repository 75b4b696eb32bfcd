#pragma once

#include <chrono>
#include <random>

namespace mqtt {

/// Pauses between attempts to connect: doubling from `first` to `longest`, each shortened at random by up to half, so
/// that many gateways do not come back to a restarted broker in one moment.
class Backoff {
 public:
  Backoff(std::chrono::milliseconds first, std::chrono::milliseconds longest, std::uint32_t seed)
      : first_(first), longest_(longest), random_(seed) {}

  [[nodiscard]] std::chrono::milliseconds next();
  /// A connection held: begin with the first pause again.
  void reset() noexcept { step_ = 0; }

 private:
  std::chrono::milliseconds first_;
  std::chrono::milliseconds longest_;
  unsigned step_ = 0;
  std::minstd_rand random_;
};

}  // namespace mqtt
