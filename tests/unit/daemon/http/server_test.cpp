#include "daemon/http/server.h"

#include <gmock/gmock.h>

#include <string>

#include "daemon/http/wire.h"
#include "tests/unit/daemon/http/server_site.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using test::kGet;
using test::RawClient;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

class HttpServer : public test::ServerSite {};

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

}  // namespace
}  // namespace gateway::http
