#pragma once

#include <iosfwd>
#include <memory>
#include <string>

#include "canopen/bus/link.h"

namespace gateway {

/// `link`, with each change of its bus told to a person on `out`, the first state included:
/// `vcan0: down: the interface is missing or switched off`.
[[nodiscard]] std::unique_ptr<canopen::Link> make_announced_link(std::unique_ptr<canopen::Link> link, std::string name,
                                                                 std::ostream& out);

}  // namespace gateway
