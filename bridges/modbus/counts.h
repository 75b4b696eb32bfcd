#pragma once

#include <array>
#include <cstdint>

#include "bridges/modbus/exception.h"

namespace modbus {

/// What all clients sent since the start.
struct Counts {
  std::uint64_t requests = 0;                  ///< Answered, exceptions included.
  std::array<std::uint64_t, 12> exceptions{};  ///< By code.
  std::uint64_t garbage = 0;                   ///< Connections that were ended since they sent what is no Modbus TCP.

  void add(Exception exception) noexcept { ++exceptions.at(static_cast<std::size_t>(exception)); }
};

}  // namespace modbus
