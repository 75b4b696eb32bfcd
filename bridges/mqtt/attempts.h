#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
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

/// How one broker is tried: at which of its addresses next, with which version of MQTT.
class Attempts {
 public:
  /// `version`: 5 or 4 (MQTT 3.1.1) only; 0: 5 with every connection, and 3.1.1 where the broker does not speak it.
  explicit Attempts(int version) : fixed_version_(version) {}

  /// Each address that is known was tried: the name is to be resolved.
  [[nodiscard]] bool wants_addresses() const noexcept { return next_ >= addresses_.size(); }
  void found(std::vector<std::string> addresses);
  /// How many of them there are.
  [[nodiscard]] std::size_t addresses() const noexcept { return addresses_.size(); }
  /// How many of them were not tried yet.
  [[nodiscard]] std::size_t untried() const noexcept { return addresses_.size() - std::min(next_, addresses_.size()); }
  /// Empty: there is none.
  [[nodiscard]] std::string next_address();
  /// The next one is the first again, of those that the name has then.
  void restart() noexcept { addresses_.clear(); }

  [[nodiscard]] int first_version() const noexcept;
  /// What came of an attempt with this version; no refusal: it stands. A version to be tried at once instead.
  [[nodiscard]] std::optional<int> next_version(const std::string& address, int version,
                                                const std::optional<Refusal>& refusal);
  /// It closed once instead of a CONNACK; another attempt shows whether it wants another version.
  [[nodiscard]] bool is_undecided(const std::string& address) const;

 private:
  int fixed_version_;
  std::vector<std::string> addresses_;
  std::size_t next_ = 0;
  std::map<std::string, int> closes_;  ///< By address: how often in a row it closed instead of a CONNACK to MQTT 5.
};

}  // namespace mqtt
