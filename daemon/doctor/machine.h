#pragma once

#include <cstdint>
#include <optional>
#include <system_error>

#include "canopen/clock.h"
#include "daemon/doctor/line.h"

namespace gateway::doctor {

/// What of the machine concerns every bus.
struct MachineFacts {
  std::error_code can{};                  ///< Of a CAN RAW socket: set where there is none to be had.
  std::optional<std::uint64_t> rmem_max;  ///< net.core.rmem_max, bytes
  canopen::WallTime now{};
  std::optional<bool> clock_synchronised{};  ///< By the kernel (adjtimex(2)); nothing: it does not say.
};

[[nodiscard]] MachineFacts look_at_machine();
[[nodiscard]] Lines judge(const MachineFacts& facts);

}  // namespace gateway::doctor
