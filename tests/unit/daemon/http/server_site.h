#pragma once

#include <gmock/gmock.h>

#include <list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "canopen/clock.h"
#include "daemon/http/server.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/http/raw_client.h"

namespace gateway::http::test {

using namespace std::chrono_literals;

inline constexpr std::string_view kGet = "GET /x HTTP/1.1\r\nHost: localhost\r\n\r\n";

/// A server that answers with the path, and its clients.
class ServerSite : public testing::Test {
 protected:
  ServerSite() { settings_.listen.port = 0; }
  ~ServerSite() override { end(); }

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
    time_.advance(wording_);
    Answer answer{.body = request.target.path};
    if (request.target.path == "/live") {
      return {.type = "text/event-stream", .stream = true};
    }
    if (request.target.path == "/long") {
      answer.body = std::string(4UL * 1024 * 1024, 'x');
    }
    if (request.target.path == "/huge") {
      answer.body = std::string(16UL * 1024 * 1024, 'x');
    }
    if (request.target.path == "/pieces") {
      answer.rest = [this, left = pieces_](std::string& text) mutable {
        ++worded_;
        time_.advance(wording_);
        text += 'x';
        return Progress{.goes_on = --left > 0};
      };
    }
    return answer;
  }

  support::HandDrivenLoop loop_;
  canopen::ManualTime time_;     ///< The same time.
  canopen::Duration wording_{};  ///< What a piece of work takes.
  int pieces_ = 3;               ///< Of a long answer.
  std::size_t worded_ = 0;       ///< Pieces of them.
  config::Http settings_;
  std::string events_;  ///< Of the stream.
  std::vector<std::string> asked_;
  std::vector<std::string> infos_;
  std::vector<std::string> warnings_;
  std::list<RawClient> clients_;
  std::unique_ptr<Server> server_;
};

}  // namespace gateway::http::test
