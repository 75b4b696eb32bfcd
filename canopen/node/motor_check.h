#pragma once

#include <boost/asio/awaitable.hpp>
#include <optional>
#include <string>

#include "canopen/error.h"
#include "canopen/node/node_settings.h"

namespace canopen {

class SdoClient;

/// Whether `raw`, read of its object, shows the sign.
[[nodiscard]] bool shows(const MotorSign& sign, Raw raw) noexcept;

/// `running`, read by SDO; nothing where no object tells it, or it cannot be read. The arguments outlive the call.
boost::asio::awaitable<std::optional<bool>> read_running(SdoClient& sdo, const MotorSigns& motor);

/// Why a node that left operational is not to be started: its motor runs, a fault is active, or the control command
/// that it holds is no stop; also where one of these should be there and cannot be read. Empty: nothing speaks against
/// it.
boost::asio::awaitable<std::string> why_not_to_start(SdoClient& sdo, const MotorSigns& motor);

}  // namespace canopen
