#include "daemon/http/server.h"

#include <gmock/gmock.h>

#include <list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "daemon/http/wire.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/http/raw_client.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using test::RawClient;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

constexpr std::string_view kGet = "GET /x HTTP/1.1\r\nHost: localhost\r\n\r\n";

class HttpServer : public testing::Test {
 protected:
  HttpServer() { settings_.listen.port = 0; }
  ~HttpServer() override { end(); }

  void start() {
    server_ = std::make_unique<Server>(
        loop_.executor(), settings_, [this](const Request& request) { return respond(request); },
        LiveSource{.begin = [] { return Live::Place{}; },
                   .take = [this](Live::Place&) { return std::exchange(events_, {}); }},
        net::Notices{.info = [this](const std::string& text) { infos_.push_back(text); },
                     .warning = [this](const std::string& text) { warnings_.push_back(text); }});
    server_->start();
    loop_.settle();
    ASSERT_NE(server_->port(), 0);
  }
  void end() {
    if (server_) {
      const auto stopped = support::spawn(loop_.executor(), server_->stop());
      EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, 1s)) << "it does not end";
      server_.reset();
    }
  }
  RawClient& connect(const std::string& from = "127.0.0.1", RawClient::Buffers buffers = RawClient::Buffers::usual) {
    RawClient& client = clients_.emplace_back(server_->port(), from, buffers);
    loop_.settle();
    return client;
  }
  std::string ask(RawClient& client, std::string_view text) {
    client.send(text);
    loop_.settle();
    return client.received();
  }
  Answer respond(const Request& request) {
    asked_.push_back(request.target.path);
    Answer answer{.body = request.target.path};
    if (request.target.path == "/live") {
      return {.type = "text/event-stream", .stream = true};
    }
    if (request.target.path == "/long") {
      answer.body = std::string(4UL * 1024 * 1024, 'x');
    }
    return answer;
  }

  support::HandDrivenLoop loop_;
  config::Http settings_;
  std::string events_;  ///< Of the stream.
  std::vector<std::string> asked_;
  std::vector<std::string> infos_;
  std::vector<std::string> warnings_;
  std::list<RawClient> clients_;
  std::unique_ptr<Server> server_;
};

TEST_F(HttpServer, AnswersOneRequestAfterTheOther) {
  start();
  RawClient& client = connect();
  EXPECT_THAT(ask(client, kGet), AllOf(StartsWith("HTTP/1.1 200 OK\r\n"), EndsWith("\r\n\r\n/x")));
  EXPECT_THAT(ask(client, "GET /y HTTP/1.1\r\nHo"), IsEmpty());
  EXPECT_THAT(ask(client, "st: localhost\r\n\r\n"), EndsWith("\r\n\r\n/y"));
  EXPECT_FALSE(client.ended());
  EXPECT_THAT(infos_, ElementsAre(HasSubstr("listening"), "HTTP: 127.0.0.1: connected"));
  EXPECT_EQ(server_->figures().answers.at(200), 2U);
}

TEST_F(HttpServer, AnswersRequestsThatWereSentAheadInOrder) {
  start();
  RawClient& client = connect();
  std::string text;
  for (int i = 0; i < 50; ++i) {
    text += "GET /" + std::to_string(i) + " HTTP/1.1\r\nHost: localhost\r\n\r\n";
  }
  const std::string answers = ask(client, text);
  std::size_t at = 0;
  for (int i = 0; i < 50; ++i) {
    at = answers.find("\r\n\r\n/" + std::to_string(i), at);
    ASSERT_NE(at, std::string::npos) << i;
  }
  EXPECT_THAT(asked_, SizeIs(50));
}

TEST_F(HttpServer, ATurnOfTheLoopTakesOneRequest) {
  start();
  RawClient& client = connect();
  std::string text;
  for (int i = 0; i < 50; ++i) {
    text += kGet;
  }
  client.send(text);
  while (asked_.size() < 50) {
    const std::size_t before = asked_.size();
    ASSERT_NE(loop_.context().poll_one(), 0U);
    EXPECT_LE(asked_.size(), before + 1);
  }
}

TEST_F(HttpServer, TellsTheLengthToHeadAndNothingElse) {
  start();
  EXPECT_THAT(ask(connect(), "HEAD /abc HTTP/1.1\r\nHost: localhost\r\n\r\n"),
              AllOf(HasSubstr("\r\nContent-Length: 4\r\n"), EndsWith("\r\n\r\n")));
}

TEST_F(HttpServer, ClosesWhereTheClientWantsThat) {
  start();
  RawClient& client = connect();
  EXPECT_THAT(ask(client, "GET /x HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
              HasSubstr("\r\nConnection: close\r\n"));
  EXPECT_TRUE(client.ended());
  RawClient& old = connect();
  EXPECT_THAT(ask(old, "GET /x HTTP/1.0\r\nHost: localhost\r\n\r\n"), HasSubstr("\r\nConnection: close\r\n"));
  EXPECT_TRUE(old.ended());
}

TEST_F(HttpServer, NothingThatIsCommandedIsTaken) {
  start();
  RawClient& client = connect();
  const std::string answer = ask(client, "POST /x HTTP/1.1\r\nHost: localhost\r\nContent-Length: 4\r\n\r\nstop");
  EXPECT_THAT(answer, AllOf(StartsWith("HTTP/1.1 405 "), HasSubstr("\r\nAllow: GET, HEAD\r\n")));
  EXPECT_TRUE(client.ended());
  EXPECT_FALSE(client.reset()) << "the answer may be lost with what was not read";
  EXPECT_THAT(asked_, IsEmpty());
}

TEST_F(HttpServer, AnswersToItsOwnNamesOnly) {
  settings_.hosts = {"line3.plant.example"};
  start();
  RawClient& client = connect();
  EXPECT_THAT(ask(client, "GET /x HTTP/1.1\r\nHost: line3.plant.example:9464\r\n\r\n"), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(ask(client, "GET /x HTTP/1.1\r\nHost: attacker.example\r\n\r\n"),
              AllOf(StartsWith("HTTP/1.1 421 "), HasSubstr("not known as \\\"attacker.example\\\""),
                    HasSubstr("[http] hosts")));
  EXPECT_THAT(ask(client, "GET http://attacker.example/x HTTP/1.1\r\nHost: localhost\r\n\r\n"),
              StartsWith("HTTP/1.1 421 "));
  EXPECT_THAT(asked_, SizeIs(1));
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("HTTP: 127.0.0.1: refused: asks for another host")));
}

TEST_F(HttpServer, ClosesWhoMayNotRead) {
  settings_.read_from = {{"127.0.0.2", 32}};
  start();
  RawClient& stranger = connect();
  EXPECT_THAT(ask(stranger, kGet), IsEmpty());
  EXPECT_TRUE(stranger.ended());
  EXPECT_THAT(ask(connect("127.0.0.2"), kGet), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(warnings_, ElementsAre("HTTP: 127.0.0.1: refused: [http] read_from does not name it"));
  EXPECT_EQ(server_->figures().refused, 1U);
}

TEST_F(HttpServer, RefusesWhatIsTooLongOrForeign) {
  start();
  RawClient& client = connect();
  EXPECT_THAT(ask(client, "GET /x HTTP/1.1\r\nX: " + std::string(2 * kMaxHead, 'x')), StartsWith("HTTP/1.1 431 "));
  EXPECT_TRUE(client.ended());
  RawClient& tls = connect();
  EXPECT_THAT(ask(tls, std::string_view("\x16\x03\x01\x02\0\x01", 6)),
              AllOf(StartsWith("HTTP/1.1 400 "), HasSubstr("write http://")));
  EXPECT_TRUE(tls.ended());
  EXPECT_THAT(asked_, IsEmpty());
}

TEST_F(HttpServer, DoesNotWaitForeverForTheRestOfARequest) {
  start();
  RawClient& client = connect();
  loop_.advance(10s, 100ms);
  ask(client, "GET");
  // A byte a second is no reason to wait longer.
  for (int i = 0; i < 6; ++i) {
    loop_.advance(1s, 100ms);
    client.send("x");
  }
  client.received();
  EXPECT_TRUE(client.ended());
  EXPECT_THAT(infos_.back(), HasSubstr("the rest of its request did not come"));
}

TEST_F(HttpServer, DisconnectsTheIdle) {
  start();
  RawClient& client = connect();
  ask(client, kGet);
  loop_.advance(74s, 1s);
  EXPECT_THAT(ask(client, kGet), Not(IsEmpty()));
  loop_.advance(77s, 1s);
  client.received();
  EXPECT_TRUE(client.ended());
  EXPECT_EQ(server_->figures().clients, 0U);
}

TEST_F(HttpServer, AClientThatTakesNothingIsDisconnected) {
  start();
  RawClient& slow = connect("127.0.0.1", RawClient::Buffers::small);
  slow.get("/long");
  loop_.settle();
  RawClient& other = connect();
  EXPECT_THAT(ask(other, kGet), StartsWith("HTTP/1.1 200 ")) << "nobody else notices";
  loop_.advance(22s, 100ms);
  EXPECT_EQ(server_->figures().clients, 1U);
  EXPECT_THAT(infos_, testing::Contains(HasSubstr("it takes nothing of its answer")));
}

TEST_F(HttpServer, WhatWaitsForSlowClientsIsBounded) {
  start();
  for (int i = 0; i < 8; ++i) {
    connect("127.0.0.1", RawClient::Buffers::small).get("/long");
  }
  loop_.settle();
  EXPECT_EQ(server_->figures().answers.at(200), 4U) << "four times 4 MB";
  EXPECT_EQ(server_->figures().answers.at(503), 4U);
  loop_.advance(22s, 100ms);
  EXPECT_THAT(ask(connect(), "GET /long HTTP/1.1\r\nHost: localhost\r\n\r\n"), StartsWith("HTTP/1.1 200 "));
}

TEST_F(HttpServer, AFurtherClientTakesThePlaceOfTheIdlest) {
  start();
  RawClient& idlest = connect("127.0.0.3");
  loop_.advance(1s, 100ms);
  for (std::size_t i = 1; i < Server::kMaxClients; ++i) {
    connect(i % 2 == 0 ? "127.0.0.1" : "127.0.0.2");
  }
  EXPECT_EQ(server_->figures().clients, Server::kMaxClients);
  EXPECT_THAT(ask(connect("127.0.0.4"), kGet), StartsWith("HTTP/1.1 200 "));
  EXPECT_EQ(server_->figures().clients, Server::kMaxClients);
  idlest.received();
  EXPECT_TRUE(idlest.ended());
}

TEST_F(HttpServer, OutlivesAClientThatLeavesInTheMiddle) {
  start();
  connect().get("/long");
  loop_.settle();
  clients_.clear();
  loop_.settle();
  EXPECT_EQ(server_->figures().clients, 0U);
  EXPECT_THAT(ask(connect(), kGet), StartsWith("HTTP/1.1 200 "));
}

TEST_F(HttpServer, EndsWithAClientThatDoesNotRead) {
  start();
  connect("127.0.0.1", RawClient::Buffers::small).get("/long");
  loop_.settle();
  end();  // expects its end
}

TEST_F(HttpServer, AStreamGoesOnUntilTheClientLeaves) {
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

TEST_F(HttpServer, ASlowReaderOfAStreamIsToldWhatItMissed) {
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

TEST_F(HttpServer, AReaderOfAStreamThatTakesNothingIsDisconnected) {
  start();
  RawClient& slow = connect("127.0.0.1", RawClient::Buffers::small);
  events_ = std::string(8UL * 1024 * 1024, 'x');
  slow.get("/live");
  loop_.advance(22s, 100ms);
  EXPECT_EQ(server_->figures().clients, 0U);
}

TEST_F(HttpServer, EndsWithReadersOfAStream) {
  start();
  connect().get("/live");
  loop_.advance(1s, 10ms);
  end();  // expects its end
}

TEST(HttpLoopShare, LeavesThreeQuartersOfTheLoopAndKeepsTheOrder) {
  support::HandDrivenLoop loop;
  canopen::Timer one(loop.executor());
  canopen::Timer other(loop.executor());
  LoopShare share;
  const canopen::TimePoint begin = canopen::Clock::now();
  share.enter(one);
  share.enter(other);
  EXPECT_LT(share.when(one), begin);
  EXPECT_EQ(share.when(other), canopen::kNever) << "it came later";
  bool woken = false;
  other.expires_at(share.when(other));
  other.async_wait([&woken](const boost::system::error_code&) { woken = true; });
  share.note(begin, begin + 5ms);
  share.leave(one);
  loop.settle();
  EXPECT_TRUE(woken);
  EXPECT_EQ(share.when(other), begin + 20ms);
  share.leave(other);
}

}  // namespace
}  // namespace gateway::http
