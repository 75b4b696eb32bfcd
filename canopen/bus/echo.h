#pragma once

#include <cstdint>

namespace canopen {

/// What the echo of our own frame proves.
enum class EchoProves : std::uint8_t {
  by_driver,  ///< What is known of the interface's driver.
  departure,  ///< The frame has left: another node acknowledged it.
  adapter     ///< Only that the adapter or the kernel has taken it.
};

}  // namespace canopen
