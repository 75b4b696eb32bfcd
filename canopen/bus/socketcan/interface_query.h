#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <system_error>

#include "canopen/bus/socketcan/descriptor.h"
#include "canopen/bus/socketcan/link_message.h"

namespace canopen::socketcan {

/// Asks the kernel by name over netlink (RTM_GETLINK); the answer is there when the request returns. While somebody
/// sets up interfaces the kernel lets it wait, usually for less than a millisecond: not for every frame.
class InterfaceQuery {
 public:
  /// Throws std::system_error where there is no netlink socket to be had.
  InterfaceQuery();

  struct Answer {
    std::error_code error;               ///< Set: the kernel did not answer; nothing is known.
    std::optional<Interface> interface;  ///< Nothing: there is no interface of that name.
  };
  [[nodiscard]] Answer ask(const std::string& name);

 private:
  Descriptor socket_;
  std::uint32_t sequence_ = 0;
};

}  // namespace canopen::socketcan
