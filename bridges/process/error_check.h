#pragma once

#include <boost/asio/awaitable.hpp>

#include "bridges/alarms/error_list.h"
#include "config/model.h"

namespace canopen {
class RemoteNode;
}

namespace process {

struct ErrorCheck {
  alarms::ErrorReadings readings;
  bool again = false;  ///< 0x1001 exists as far as anybody knows, but did not answer.
};

/// 0x1001 alone.
[[nodiscard]] boost::asio::awaitable<ErrorCheck> check_error_register(canopen::RemoteNode& node);

/// Asks a drive for its errors: 0x1001, and where that is not 0 the fault code, and where that is 0 the newest entry of
/// 0x1003. `model` and `node` outlive the call.
[[nodiscard]] boost::asio::awaitable<ErrorCheck> check_errors(const config::Drive& model, canopen::RemoteNode& node);

}  // namespace process
