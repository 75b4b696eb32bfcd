#pragma once

#include <boost/asio/awaitable.hpp>
#include <string>

#include "canopen/node/life.h"
#include "canopen/object.h"

namespace canopen {

class SdoClient;

/// The bits of an error register (0x1001, CiA 301 §7.5.2.2) by name, as in "current, communication"; empty for 0.
[[nodiscard]] std::string error_register_text(Raw error_register);

/// What a node says of its errors, for people: 0x1001, and the newest entries of its error field 0x1003, four at most.
/// What it does not have, or does not tell, is said, too. Empty where the life is over. The arguments outlive the call.
boost::asio::awaitable<std::string> read_error_report(SdoClient& sdo, const Life& life);

}  // namespace canopen
