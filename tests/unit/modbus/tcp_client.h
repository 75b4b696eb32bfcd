#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "tests/unit/modbus/bytes.h"

namespace modbus_test {

/// A plain client socket that never waits.
class TcpClient {
 public:
  enum class Buffers : std::uint8_t { usual, small };

  /// Numeric IPv4 or IPv6 addresses; `from`: IPv4 only. Connecting on this machine succeeds before anybody accepts.
  explicit TcpClient(std::uint16_t port, const std::string& host = "127.0.0.1", Buffers buffers = Buffers::usual,
                     const std::string& from = {});
  ~TcpClient();
  TcpClient(const TcpClient&) = delete;
  TcpClient& operator=(const TcpClient&) = delete;

  /// Returns how many bytes the socket took.
  std::size_t send(std::span<const std::uint8_t> bytes);
  /// Says that nothing more will be sent.
  void finish();
  /// Takes in what has come.
  void receive();
  /// A complete frame has come, the first of `input`.
  [[nodiscard]] bool has_frame() const;
  Bytes take_frame();
  [[nodiscard]] bool closed() const noexcept { return closed_; }
  [[nodiscard]] bool connected() const noexcept { return connected_; }

 private:
  int socket_;
  bool connected_ = false;
  bool closed_ = false;
  Bytes input_;
};

}  // namespace modbus_test
