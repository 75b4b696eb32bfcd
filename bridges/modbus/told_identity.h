#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <span>
#include <vector>

#include "bridges/modbus/identification.h"
#include "bridges/process/drive.h"

namespace modbus {

/// What of its identity only the drive itself can tell, read by SDO as far as `pdu`, a request of 43/14, asks for it.
/// `pdu` and `drive` outlive the call. An object that the drive does not have: illegal_address; one that it does not
/// tell now: no_response.
[[nodiscard]] boost::asio::awaitable<std::vector<IdentityObject>> told_identity(process::Drive& drive,
                                                                                std::span<const std::uint8_t> pdu);

}  // namespace modbus
