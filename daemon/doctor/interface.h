#pragma once

#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "canopen/bus/socketcan/link_message.h"
#include "config/model.h"
#include "daemon/doctor/line.h"

namespace gateway::doctor {

/// What the kernel says of the interface of a bus.
struct InterfaceFacts {
  std::error_code error{};                                   ///< Set: it did not answer.
  std::optional<canopen::socketcan::Interface> interface{};  ///< Nothing: there is none of that name.
  bool is_can = true;                                        ///< Of the kind that takes CAN frames.
  std::string driver{};                                      ///< Empty: the kernel names none.
  std::vector<std::string> others{};                         ///< CAN interfaces of this machine.
};

[[nodiscard]] InterfaceFacts look_at_interface(const std::string& name);
/// `bus` is none of kVirtualInterface.
[[nodiscard]] Lines judge(const config::Bus& bus, const InterfaceFacts& facts);

}  // namespace gateway::doctor
