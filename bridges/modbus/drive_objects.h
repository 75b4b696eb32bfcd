#pragma once

#include <boost/asio/awaitable.hpp>
#include <cstdint>
#include <span>
#include <vector>

#include "bridges/modbus/encapsulated.h"
#include "bridges/modbus/general_reference.h"
#include "bridges/modbus/identification.h"
#include "bridges/process/command.h"
#include "bridges/process/drive.h"

// What function 43 reads and writes in a drive.

namespace modbus {

/// What of its identity only the drive itself can tell, read by SDO as far as `pdu`, a request of 43/14, asks for it.
/// `pdu` and `drive` outlive the call. An object that the drive does not have: illegal_address; one that it does not
/// tell now: no_response.
[[nodiscard]] boost::asio::awaitable<std::vector<IdentityObject>> told_identity(process::Drive& drive,
                                                                                std::span<const std::uint8_t> pdu);

/// Carries `pdu`, which is that of `reference` and outlives the call, out on that drive.
[[nodiscard]] boost::asio::awaitable<EncapsulatedAnswer> carry_out(process::Drive& drive,
                                                                   std::span<const std::uint8_t> pdu,
                                                                   Reference reference, process::Origin origin);

}  // namespace modbus
