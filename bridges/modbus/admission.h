#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <optional>
#include <span>

#include "canopen/clock.h"

namespace modbus {

/// Whoever connects, and whoever is connected.
struct Caller {
  boost::asio::ip::address address;
  bool may_write = false;  ///< Of `write_from`.
  /// When it last asked; nothing while a command is carried out for it.
  std::optional<canopen::TimePoint> silent_since{};
};

struct Admission {
  const char* refusal = nullptr;            ///< Why not, for the log; null: it may stay.
  std::optional<std::size_t> instead_of{};  ///< The client, by its position, that makes room.
};

/// Whether one more may connect. `max_clients` is at least 1.
[[nodiscard]] Admission admit(const Caller& caller, std::span<const Caller> clients, std::size_t max_clients,
                              canopen::TimePoint now);

}  // namespace modbus
