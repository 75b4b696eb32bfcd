#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "bridges/mqtt/client.h"
#include "config/model.h"

namespace mqtt {

/// Numeric addresses of a host, IPv6 without brackets, best first; empty where there are none. Blocks, with a bad name
/// server for long. Paho gets a numeric address, because while it resolves a name itself every other call into it
/// waits.
using Resolver = std::function<std::vector<std::string>(const config::Endpoint&)>;

[[nodiscard]] std::vector<std::string> resolve(const config::Endpoint& endpoint);

/// A host as it stands in a URI.
[[nodiscard]] std::string uri_host(const std::string& host);

/// How the next attempt to connect is made: to which address, with which version of MQTT, after which pause. Pauses
/// double from `first` to `longest`, each shortened at random by up to half, so that many gateways do not come back to
/// a restarted broker in one moment.
class Attempts {
 public:
  using Milliseconds = std::chrono::milliseconds;

  /// `version`: 5 or 4 (MQTT 3.1.1) only; 0: 5 with every connection, and 3.1.1 where the broker does not speak it.
  Attempts(int version, Milliseconds first, Milliseconds longest, std::uint32_t seed)
      : fixed_version_(version), first_(first), longest_(longest), random_(seed) {}

  /// Each address that is known was tried: the name is to be resolved.
  [[nodiscard]] bool wants_addresses() const noexcept { return next_ >= addresses_.size(); }
  void found(std::vector<std::string> addresses);
  /// Empty: there is none.
  [[nodiscard]] std::string next_address();

  [[nodiscard]] int first_version() const noexcept;
  /// What came of an attempt with this version; no refusal: it stands. A version to be tried at once instead.
  [[nodiscard]] std::optional<int> next_version(const std::string& address, int version,
                                                const std::optional<Refusal>& refusal);

  [[nodiscard]] Milliseconds next_pause();
  /// A connection held: begin with the first pause again.
  void held() noexcept { step_ = 0; }

 private:
  int fixed_version_;
  std::vector<std::string> addresses_;
  std::size_t next_ = 0;
  std::map<std::string, int> closes_;  ///< By address: how often in a row it closed instead of a CONNACK to MQTT 5.
  Milliseconds first_;
  Milliseconds longest_;
  unsigned step_ = 0;
  std::minstd_rand random_;
};

}  // namespace mqtt
