#include <gmock/gmock.h>

#include <string>

#include "daemon/http/server.h"
#include "tests/unit/daemon/http/server_site.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using test::RawClient;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class HttpStream : public test::ServerSite {};

TEST_F(HttpStream, AStreamGoesOnUntilTheClientLeaves) {
  start();
  RawClient& client = connect();
  events_ = "event: a\ndata: 1\n\n";
  client.get("/live");
  loop_.settle();
  EXPECT_THAT(client.received(), AllOf(HasSubstr("\r\nContent-Type: text/event-stream\r\n"),
                                       Not(HasSubstr("Content-Length")), EndsWith("\r\n\r\nevent: a\ndata: 1\n\n")));
  events_ = "event: b\ndata: 2\n\n";
  loop_.advance(249ms);
  EXPECT_THAT(client.received(), IsEmpty());
  loop_.advance(1ms);
  EXPECT_EQ(client.received(), "event: b\ndata: 2\n\n");
  loop_.advance(16s, 10ms);
  EXPECT_EQ(client.received(), ":\n\n") << "a sign of life";
  loop_.advance(100s, 100ms);
  EXPECT_FALSE(client.ended()) << "it is not idle";
  clients_.clear();
  loop_.advance(31s, 100ms);
  EXPECT_EQ(server_->figures().clients, 0U);
}

TEST_F(HttpStream, ASlowReaderOfAStreamIsToldWhatItMissed) {
  start();
  RawClient& slow = connect("127.0.0.1", RawClient::Buffers::small);
  events_ = std::string(8UL * 1024 * 1024, 'x');
  slow.get("/live");
  loop_.advance(5s, 10ms);
  std::string got;
  for (int i = 0; i < 10'000 && got.find("skipped") == std::string::npos; ++i) {
    got += slow.received();
    loop_.advance(1ms);
  }
  ASSERT_GT(got.size(), 100U);
  EXPECT_THAT(got.substr(got.size() - 100), HasSubstr("event: skipped\ndata: {\"times\":"));
}

TEST_F(HttpStream, AReaderOfAStreamThatTakesNothingIsDisconnected) {
  start();
  RawClient& slow = connect("127.0.0.1", RawClient::Buffers::small);
  events_ = std::string(8UL * 1024 * 1024, 'x');
  slow.get("/live");
  loop_.advance(22s, 100ms);
  EXPECT_EQ(server_->figures().clients, 0U);
}

TEST_F(HttpStream, TheSystemKeepsLittleOfWhatAReaderDoesNotTake) {
  start();
  RawClient& slow = connect("127.0.0.1", RawClient::Buffers::small);
  events_ = std::string(512UL * 1024, 'x');
  slow.get("/live");
  loop_.advance(22s, 100ms);
  EXPECT_EQ(server_->figures().clients, 0U) << "all of it found room somewhere";
}

TEST_F(HttpStream, EndsWithReadersOfAStream) {
  start();
  connect().get("/live");
  loop_.advance(1s, 10ms);
  end();  // expects its end
}

TEST_F(HttpStream, ReadersOfTheStreamLeaveRoomForOthersOfTheirAddress) {
  start();
  for (std::size_t i = 0; i <= Server::kMaxStreamsOfAddress; ++i) {
    connect().get("/live");
  }
  loop_.settle();
  EXPECT_EQ(server_->figures().answers.at(200), Server::kMaxStreamsOfAddress);
  EXPECT_EQ(server_->figures().answers.at(503), 1U);
  EXPECT_THAT(ask(connect("127.0.0.2"), "GET /live HTTP/1.1\r\nHost: localhost\r\n\r\n"),
              HasSubstr("text/event-stream"));
}

}  // namespace
}  // namespace gateway::http
