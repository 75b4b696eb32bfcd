#include "daemon/control/exchange.h"

#include <gmock/gmock.h>

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/write.hpp>
#include <functional>
#include <string>
#include <thread>

#include "daemon/temporary_directory.h"

namespace gateway::control {
namespace {

using namespace std::chrono_literals;
using boost::asio::local::stream_protocol;
using testing::HasSubstr;

class ControlExchange : public testing::Test {
 protected:
  /// A server for one client, on a thread of its own since the exchange waits.
  void serve(const std::function<void(stream_protocol::socket&)>& with) {
    acceptor_ = stream_protocol::acceptor(context_, stream_protocol::endpoint(path_.string()));
    server_ = std::jthread([this, with] {
      stream_protocol::socket client = acceptor_.accept();
      std::array<char, 256> buffer{};
      request_.assign(buffer.data(), client.read_some(boost::asio::buffer(buffer)));
      with(client);
    });
  }

  TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_.path() / "control";
  boost::asio::io_context context_;
  stream_protocol::acceptor acceptor_{context_};
  std::string request_;
  std::jthread server_;
};

TEST_F(ControlExchange, GivesTheFirstLineThatComesInPieces) {
  serve([](stream_protocol::socket& client) {
    boost::asio::write(client, boost::asio::buffer(std::string("{\"id\":")));
    boost::asio::write(client, boost::asio::buffer(std::string("1}\nmore\n")));
  });
  const Exchanged exchanged = exchange(path_, "{}", 10s);
  EXPECT_EQ(exchanged.answer, "{\"id\":1}");
  EXPECT_EQ(exchanged.problem, "");
  server_.join();
  EXPECT_EQ(request_, "{}\n");
}

TEST_F(ControlExchange, TellsOfAConnectionThatEnds) {
  serve([](stream_protocol::socket& client) { client.close(); });
  EXPECT_THAT(exchange(path_, "{}", 10s).problem, HasSubstr("ended the connection"));
}

TEST_F(ControlExchange, TellsOfAServerThatIsSilent) {
  serve([](stream_protocol::socket& client) {
    std::array<char, 1> rest{};
    boost::system::error_code end;
    client.read_some(boost::asio::buffer(rest), end);  // until the other side gives up
  });
  EXPECT_THAT(exchange(path_, "{}", 20ms).problem, HasSubstr("has not answered within 0 s"));
}

TEST_F(ControlExchange, TellsWhereNobodyListens) {
  EXPECT_THAT(exchange(path_, "{}", 10s).problem, HasSubstr("No such file or directory; does the gateway run"));
  EXPECT_THAT(exchange(std::string(200, 'x'), "{}", 10s).problem, HasSubstr("no path of a socket"));
  EXPECT_THAT(exchange("", "{}", 10s).problem, HasSubstr("no path of a socket"));
}

}  // namespace
}  // namespace gateway::control
