#pragma once

#include <cstdint>
#include <string_view>

namespace simulator {

/// NMT states with the numbers heartbeats carry (CiA 301 §7.2.8.3.2.2), and `off` for a drive without power.
enum class NmtState : std::uint8_t { initialising = 0, stopped = 4, operational = 5, pre_operational = 127, off = 255 };

[[nodiscard]] constexpr std::string_view to_string(NmtState state) noexcept {
  switch (state) {
    case NmtState::initialising:
      return "initialising";
    case NmtState::stopped:
      return "stopped";
    case NmtState::operational:
      return "operational";
    case NmtState::pre_operational:
      return "pre-operational";
    case NmtState::off:
      break;
  }
  return "off";
}

}  // namespace simulator
