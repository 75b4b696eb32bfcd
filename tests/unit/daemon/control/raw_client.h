#pragma once

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gateway::control::test {

/// A client of the control socket that shares a thread with the server: it never waits.
class RawClient {
 public:
  explicit RawClient(const std::filesystem::path& path) : socket_(context_) {
    socket_.connect(boost::asio::local::stream_protocol::endpoint(path.string()));
    socket_.non_blocking(true);
  }

  /// As much as the kernel takes; the count.
  std::size_t send(std::string_view text) {
    boost::system::error_code full;
    return boost::asio::write(socket_, boost::asio::buffer(text), full);
  }
  /// Sends no more, but reads on.
  void end() { socket_.shutdown(boost::asio::local::stream_protocol::socket::shutdown_send); }
  void close() { socket_.close(); }

  /// The lines that came since the call before.
  std::vector<std::string> lines() {
    boost::system::error_code failed;
    std::array<char, 65536> buffer{};
    while (!failed) {
      received_.append(buffer.data(), socket_.read_some(boost::asio::buffer(buffer), failed));
    }
    ended_ = failed != boost::asio::error::would_block;
    std::vector<std::string> lines;
    for (std::size_t end = received_.find('\n'); end != std::string::npos; end = received_.find('\n')) {
      lines.push_back(received_.substr(0, end));
      received_.erase(0, end + 1);
    }
    return lines;
  }
  /// Whether lines() found the connection ended by the server.
  [[nodiscard]] bool ended() const noexcept { return ended_; }

 private:
  boost::asio::io_context context_;
  boost::asio::local::stream_protocol::socket socket_;
  std::string received_;
  bool ended_ = false;
};

}  // namespace gateway::control::test
