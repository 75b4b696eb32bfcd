#pragma once

#include <boost/asio/ip/address.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gateway::http {

/// The host of `line3:9464`, `[2001:db8::7]:9464` without its port: in lower case, an address in its one spelling, a
/// name without the dot at its end. Nothing: it is no host.
[[nodiscard]] std::optional<std::string> host_of(std::string_view header);

/// The names that this machine is asked under. A page of somebody else that a browser was made to take for ours (DNS
/// rebinding) asks under its own name, and must be told nothing.
class Hosts {
 public:
  /// `further`: beside the loopback names and the machine's own addresses; in lower case, a dot at the end is none of
  /// it.
  explicit Hosts(std::vector<std::string> further);

  /// `header` is what the client wrote; `own` the address at which its connection came in.
  [[nodiscard]] bool knows(std::string_view header, const boost::asio::ip::address& own) const;

 private:
  std::vector<std::string> further_;
};

}  // namespace gateway::http
