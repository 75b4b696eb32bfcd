#pragma once

#include <modbus/modbus.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace bench {

/// For how long round trips are measured at a time.
inline constexpr std::chrono::milliseconds kRound{1000};

/// A Modbus connection to this machine, one request at a time. Throws std::runtime_error for anything but a normal
/// answer.
class RoundTripClient {
 public:
  RoundTripClient(std::uint16_t port, std::uint8_t unit);
  ~RoundTripClient();
  RoundTripClient(const RoundTripClient&) = delete;
  RoundTripClient& operator=(const RoundTripClient&) = delete;

  /// Ten registers.
  void read();
  /// A set-point that the drive has to confirm.
  void command();

 private:
  std::unique_ptr<modbus_t, void (*)(modbus_t*)> context_;
  unsigned commands_ = 0;
};

/// The time that 99 of 100 calls need at most, in µs, called one after another for so long.
[[nodiscard]] double p99(const std::function<void()>& call, std::chrono::milliseconds time = kRound);

/// Times of p99() without and with a load, in turn.
struct RoundTrips {
  std::string what;
  std::vector<double> before;
  std::vector<double> during;
};

/// `what  p99 before M us, in it M us, ratio M (min..max of the pairs)`: medians. The ratio is given back.
double print(const RoundTrips& times);

}  // namespace bench
