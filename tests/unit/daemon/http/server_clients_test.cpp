#include <gmock/gmock.h>

#include <string>

#include "daemon/http/server.h"
#include "tests/unit/daemon/http/server_site.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using test::kGet;
using test::RawClient;
using testing::AnyOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class HttpClients : public test::ServerSite {};

TEST_F(HttpClients, ClosesWhoMayNotRead) {
  settings_.read_from = {{"127.0.0.2", 32}};
  start();
  RawClient& stranger = connect();
  EXPECT_THAT(ask(stranger, kGet), IsEmpty());
  EXPECT_TRUE(stranger.ended());
  EXPECT_THAT(ask(connect("127.0.0.2"), kGet), StartsWith("HTTP/1.1 200 "));
  EXPECT_THAT(warnings_, ElementsAre("HTTP: 127.0.0.1: refused: [http] read_from does not name it"));
  EXPECT_EQ(server_->figures().refused, 1U);
}

TEST_F(HttpClients, DoesNotWaitForeverForTheRestOfARequest) {
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

TEST_F(HttpClients, DisconnectsTheIdle) {
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

TEST_F(HttpClients, AClientThatTakesNothingIsDisconnected) {
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

TEST_F(HttpClients, AClientThatTakesTooLittleIsDisconnected) {
  start();
  RawClient& slow = connect("127.0.0.1", RawClient::Buffers::small);
  slow.get("/huge");
  loop_.settle();
  for (int i = 0; i < 120; ++i) {
    loop_.advance(15s, 1s);
    slow.take(64UL * 1024);
  }
  EXPECT_EQ(server_->figures().clients, 0U) << "16 MB may take half an hour";
  EXPECT_THAT(infos_.back(), AnyOf(HasSubstr("too slowly"), HasSubstr("takes nothing")))
      << "the system has buffers, too";
}

TEST_F(HttpClients, AFurtherClientTakesThePlaceOfTheIdlest) {
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

TEST_F(HttpClients, OutlivesAClientThatLeavesInTheMiddle) {
  start();
  connect().get("/long");
  loop_.settle();
  clients_.clear();
  loop_.settle();
  EXPECT_EQ(server_->figures().clients, 0U);
  EXPECT_THAT(ask(connect(), kGet), StartsWith("HTTP/1.1 200 "));
}

TEST_F(HttpClients, EndsWithAClientThatDoesNotRead) {
  start();
  connect("127.0.0.1", RawClient::Buffers::small).get("/long");
  loop_.settle();
  end();  // expects its end
}

}  // namespace
}  // namespace gateway::http
