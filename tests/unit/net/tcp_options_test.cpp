#include "bridges/net/tcp_options.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <thread>

namespace {

using boost::asio::ip::tcp;

/// Two ends of a connection on loopback.
class TcpOptions : public testing::Test {
 protected:
  TcpOptions() {
    tcp::acceptor acceptor(loop_, tcp::endpoint(boost::asio::ip::address_v4::loopback(), 0));
    client_.open(tcp::v4());
    client_.set_option(tcp::socket::receive_buffer_size(4096));
    client_.connect(acceptor.local_endpoint());
    server_ = acceptor.accept();
    server_.non_blocking(true);
    client_.non_blocking(true);
    net::prepare(server_);
  }

  [[nodiscard]] int option(int name) {
    int value = -1;
    socklen_t size = sizeof value;
    EXPECT_EQ(::getsockopt(server_.native_handle(), IPPROTO_TCP, name, &value, &size), 0);
    return value;
  }
  /// The kernel carries what loopback has at once, but acknowledges in its own time.
  [[nodiscard]] bool comes_to(int user_timeout) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
    while (std::chrono::steady_clock::now() < end) {
      slow_reader_.look(server_);
      if (option(TCP_USER_TIMEOUT) == user_timeout) {
        return true;
      }
      std::this_thread::yield();
    }
    return false;
  }

  boost::asio::io_context loop_;
  tcp::socket client_{loop_};
  tcp::socket server_{loop_};
  net::SlowReader slow_reader_;
};

TEST_F(TcpOptions, ACutCableIsNoticedWithinThirtySeconds) {
  EXPECT_EQ(option(TCP_USER_TIMEOUT), 25'000);
  EXPECT_LT(option(TCP_KEEPIDLE) + 2 * option(TCP_KEEPINTVL), 25) << "two probes may be lost";
  EXPECT_EQ((25 - option(TCP_KEEPIDLE)) % option(TCP_KEEPINTVL), 0) << "a probe's timer falls on the limit";
}

TEST_F(TcpOptions, AClientThatDoesNotReadIsSparedUntilItReads) {
  slow_reader_.look(server_);
  EXPECT_EQ(option(TCP_USER_TIMEOUT), 25'000);
  std::array<char, 4096> bytes{};
  boost::system::error_code failed;
  slow_reader_.on_answer();
  while (!failed) {
    server_.write_some(boost::asio::buffer(bytes), failed);
  }
  ASSERT_EQ(failed, boost::asio::error::would_block);
  EXPECT_TRUE(comes_to(0)) << "its window is shut";
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  while (option(TCP_USER_TIMEOUT) == 0 && std::chrono::steady_clock::now() < end) {
    client_.read_some(boost::asio::buffer(bytes), failed);
    slow_reader_.look(server_);
  }
  EXPECT_EQ(option(TCP_USER_TIMEOUT), 25'000) << "it reads";
}

}  // namespace
