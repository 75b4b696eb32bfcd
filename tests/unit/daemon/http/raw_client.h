#pragma once

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <cstdint>
#include <string>
#include <string_view>

namespace gateway::http::test {

/// A client that shares a thread with the server: it never waits.
class RawClient {
 public:
  enum class Buffers : std::uint8_t { usual, small };

  explicit RawClient(std::uint16_t port, const std::string& from = "127.0.0.1", Buffers buffers = Buffers::usual)
      : socket_(context_) {
    using boost::asio::ip::make_address;
    using boost::asio::ip::tcp;
    socket_.open(tcp::v4());
    if (buffers == Buffers::small) {
      socket_.set_option(tcp::socket::receive_buffer_size(4096));
    }
    socket_.bind({make_address(from), 0});
    socket_.connect({make_address("127.0.0.1"), port});
    socket_.set_option(tcp::no_delay(true));  // the second piece of a request does not wait for the first one's receipt
    socket_.non_blocking(true);
  }

  /// As much as the kernel takes; the count.
  std::size_t send(std::string_view text) {
    boost::system::error_code full;
    return boost::asio::write(socket_, boost::asio::buffer(text), full);
  }
  void get(std::string_view target, std::string_view host = "localhost") {
    send("GET " + std::string(target) + " HTTP/1.1\r\nHost: " + std::string(host) + "\r\n\r\n");
  }
  void end() { socket_.shutdown(boost::asio::ip::tcp::socket::shutdown_send); }

  /// Takes no more than so many bytes of what came.
  void take(std::size_t most) {
    boost::system::error_code failed;
    for (std::string piece(4096, '\0'); most >= piece.size() && !failed; most -= piece.size()) {
      socket_.read_some(boost::asio::buffer(piece), failed);
    }
  }
  /// What came since the call before.
  std::string received() {
    boost::system::error_code failed;
    std::array<char, 65536> buffer{};
    std::string text;
    while (!failed) {
      text.append(buffer.data(), socket_.read_some(boost::asio::buffer(buffer), failed));
    }
    ended_ = failed != boost::asio::error::would_block;
    reset_ = failed == boost::asio::error::connection_reset;
    return text;
  }
  /// Whether received() found the connection ended by the server.
  [[nodiscard]] bool ended() const noexcept { return ended_; }
  [[nodiscard]] bool reset() const noexcept { return reset_; }

 private:
  boost::asio::io_context context_;
  boost::asio::ip::tcp::socket socket_;
  bool ended_ = false;
  bool reset_ = false;
};

}  // namespace gateway::http::test
