#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace canopen {

class SetupSession;

/// Where a node's emergencies go (0x1014).
enum class EmcyService : std::uint8_t {
  as_expected,  ///< Under 0x80 + node, or the node does not tell.
  off,          ///< Nowhere: bit 31 is set.
  moved         ///< Under another COB-ID, where nobody listens.
};

struct EmcyVerdict {
  EmcyService service = EmcyService::as_expected;
  std::string text{};  ///< For people: what 0x1014 says, and why it could not be written. Empty: as expected.
  friend bool operator==(const EmcyVerdict&, const EmcyVerdict&) = default;
};

/// Reads 0x1014. While configuring, and where EmcySettings::enable allows it, writes what differs and reads it back,
/// with a line to `remarks`. No failure of a configuration: a node whose emergencies are missing can be run. Nothing:
/// the node did not answer, so that what was known of it stands.
boost::asio::awaitable<std::optional<EmcyVerdict>> set_up_emcy(SetupSession& session,
                                                               std::vector<std::string>& remarks);

}  // namespace canopen
