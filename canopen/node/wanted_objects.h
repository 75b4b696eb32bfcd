#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "canopen/node/node_settings.h"
#include "canopen/node/pdo_setup.h"
#include "canopen/node/setup_session.h"
#include "canopen/object.h"

// The objects of a node that its settings decide, as they have to be. Who sets a node up and who only looks at it take
// them from here.

namespace canopen {

inline constexpr Raw kPdoInvalid = 0x8000'0000;       ///< Bit 31 of a COB-ID: the PDO does not exist.
inline constexpr Raw kPdoRtrForbidden = 0x4000'0000;  ///< Bit 30; devices keep it as they like.

/// `TPDO1`
[[nodiscard]] std::string pdo_name(PdoRole role, const PdoSettings& pdo);
/// The communication object, 0x1400 or 0x1800 and more; the mapping object is 0x200 above it.
[[nodiscard]] std::uint16_t pdo_communication(PdoRole role, const PdoSettings& pdo) noexcept;

[[nodiscard]] SetupItem wanted_cob_id(PdoRole role, const PdoSettings& pdo, Raw wanted);
/// Transmission type and times, as far as they are stated. Of communication that is only assumed the event timer alone.
[[nodiscard]] std::vector<SetupItem> wanted_parameters(PdoRole role, const PdoSettings& pdo);
/// The number of objects first, then each.
[[nodiscard]] std::vector<SetupItem> wanted_mapping(PdoRole role, const PdoSettings& pdo);

/// A person relies on its event timer to end what was commanded, whatever the policies say.
[[nodiscard]] bool relies_on_timer(const PdoSettings& pdo) noexcept;
/// Why a node cannot serve the PDO that lacks its communication object, its mapping object, or only its event timer;
/// for people. Empty where it can: then what is documented is taken for granted.
[[nodiscard]] std::string why_not_without_object(PdoRole role, const PdoSettings& pdo);
[[nodiscard]] std::string why_not_without_mapping(PdoRole role, const PdoSettings& pdo);
[[nodiscard]] std::string why_not_without_timer(PdoRole role, const PdoSettings& pdo);

/// 0x1017
[[nodiscard]] SetupItem wanted_heartbeat(const ErrorControlSettings& control);

}  // namespace canopen
