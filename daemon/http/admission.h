#pragma once

#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <optional>
#include <span>

#include "canopen/clock.h"

namespace gateway::http {

/// Who is connected.
struct Guest {
  boost::asio::ip::address address;
  std::optional<canopen::TimePoint> idle_since{};  ///< Nothing while it is being answered.
};

struct Admission {
  const char* refusal = nullptr;            ///< Why not, for the log; null: it may stay.
  std::optional<std::size_t> instead_of{};  ///< The guest, by its position, that makes room.
};

/// Whether one more may connect, where there is room for `most` in all and half of them for one address. Whoever is
/// idle longest makes room, of its own address where that has its half.
[[nodiscard]] Admission admit(const boost::asio::ip::address& address, std::span<const Guest> guests, std::size_t most);

}  // namespace gateway::http
