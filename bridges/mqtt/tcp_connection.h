#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace mqtt {

/// A socket that nobody else closes.
struct TcpConnection {
  explicit TcpConnection(int opened = -1) noexcept : descriptor(opened) {}
  ~TcpConnection();
  TcpConnection(TcpConnection&& other) noexcept : descriptor(std::exchange(other.descriptor, -1)) {}
  TcpConnection(const TcpConnection&) = delete;
  TcpConnection& operator=(const TcpConnection&) = delete;
  TcpConnection& operator=(TcpConnection&&) = delete;
  int descriptor;  ///< Negative: there is none. Its calls do not block.
};

/// To the first of these numeric addresses that accepts; none: no one does until `end`. As Paho, IPv4 goes before IPv6.
/// None takes the time of those behind it.
[[nodiscard]] TcpConnection connect_to(const std::vector<std::string>& addresses, std::uint16_t port,
                                       std::chrono::steady_clock::time_point end);

/// Until one of `events` of poll(); false: not until `end`.
[[nodiscard]] bool wait_for(const TcpConnection& connection, short events, std::chrono::steady_clock::time_point end);

}  // namespace mqtt
