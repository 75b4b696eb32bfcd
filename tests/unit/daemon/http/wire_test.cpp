#include "daemon/http/wire.h"

#include <gmock/gmock.h>

#include "tests/support/hand_driven_loop.h"

namespace gateway::http {
namespace {

using testing::HasSubstr;
using testing::Not;

Request request_of(const std::string& head) {
  auto read = read_head(head);
  if (const auto* const refused = std::get_if<Refused>(&read)) {
    ADD_FAILURE() << refused->answer.body;
    return {};
  }
  return std::get<Request>(std::move(read));
}

Answer refusal_of(const std::string& head) {
  auto read = read_head(head);
  if (std::holds_alternative<Request>(read)) {
    ADD_FAILURE() << "it is taken: " << head;
    return {};
  }
  return std::get<Refused>(std::move(read)).answer;
}

TEST(HttpWire, FindsTheEndOfARequest) {
  const std::string one = "GET / HTTP/1.1\r\nHost: a\r\n\r\n";
  EXPECT_EQ(find_head_end(one, 0), one.size());
  EXPECT_EQ(find_head_end(one + one, 0), one.size());
  EXPECT_EQ(find_head_end("\r\n\r\n" + one, 0), one.size() + 4) << "blank lines before it";
  for (std::size_t size = 0; size < one.size(); ++size) {
    EXPECT_EQ(find_head_end(one.substr(0, size), 0), std::nullopt) << size;
    EXPECT_EQ(find_head_end(one, size), one.size()) << size << " were looked at";
  }
}

TEST(HttpWire, KnowsWhatIsNoHttp) {
  EXPECT_TRUE(is_foreign("\x16\x03\x01"));
  EXPECT_TRUE(is_foreign(std::string_view("\0", 1)));
  EXPECT_TRUE(is_foreign("\r\n{}"));
  EXPECT_FALSE(is_foreign("G"));
  EXPECT_FALSE(is_foreign("\r\n"));
  EXPECT_FALSE(is_foreign(""));
}

TEST(HttpWire, ReadsRequests) {
  const Request request = request_of("\r\nGET /api/drives?a=1 HTTP/1.1\r\nhOST: line3:9464\r\nX: y\r\n\r\n");
  EXPECT_EQ(request.method, Method::get);
  EXPECT_EQ(request.target.path, "/api/drives");
  EXPECT_EQ(request.host, "line3:9464");
  EXPECT_TRUE(request.keep_alive);
  EXPECT_EQ(request_of("HEAD / HTTP/1.1\r\nHost: a\r\n\r\n").method, Method::head);
  EXPECT_FALSE(request_of("GET / HTTP/1.1\r\nHost: a\r\nConnection: close\r\n\r\n").keep_alive);
  EXPECT_FALSE(request_of("GET / HTTP/1.0\r\nHost: a\r\n\r\n").keep_alive);
  EXPECT_EQ(request_of("GET http://b/ HTTP/1.1\r\nHost: a\r\n\r\n").host, "b") << "RFC 9112, section 3.2.2";
  EXPECT_EQ(request_of("GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 0\r\n\r\n").host, "a");
}

TEST(HttpWire, TakesGetAndHeadOnly) {
  for (const char* const method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH", "BREW", "TRACE"}) {
    const Answer answer = refusal_of(std::string(method) + " / HTTP/1.1\r\nHost: a\r\n\r\n");
    EXPECT_EQ(answer.status, 405U) << method;
    EXPECT_EQ(answer.allow, "GET, HEAD");
    EXPECT_THAT(word_head(answer, false), HasSubstr("\r\nAllow: GET, HEAD\r\n"));
  }
}

TEST(HttpWire, TakesNoBody) {
  EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 5\r\n\r\n").status, 413U);
  EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 18446744073709551615\r\n\r\n").status / 100, 4U);
  for (const char* const coding : {"chunked", "gzip", "chunked, gzip", "gzip, chunked", "identity", "x"}) {
    EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\nHost: a\r\nTransfer-Encoding: " + std::string(coding) + "\r\n\r\n").status,
              413U)
        << coding;
  }
}

TEST(HttpWire, RefusesWhatIsNoRequest) {
  for (const char* const head :
       {"hello\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/2.0\r\nHost: a\r\n\r\n", "GET / HTTP/1.1\r\nHost a\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nContent-Length: x\r\n\r\n",
        "GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n", "GET /\x7f HTTP/1.1\r\n\r\n"}) {
    EXPECT_EQ(refusal_of(head).status, 400U) << head;
  }
  EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\n\r\n").status, 400U) << "no host";
  EXPECT_EQ(refusal_of("GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n").status, 400U) << "two";
  const Answer percent = refusal_of("GET /?a=%zz HTTP/1.1\r\nHost: a\r\n\r\n");
  EXPECT_EQ(percent.status, 400U);
  EXPECT_THAT(percent.body, HasSubstr("byte 5 of the target"));
  EXPECT_EQ(refusal_of("GET /" + std::string(kMaxTarget, 'a') + " HTTP/1.1\r\nHost: a\r\n\r\n").status, 414U);
}

TEST(HttpWire, WordsAnswers) {
  const support::HandDrivenLoop loop;
  const std::string head = word_head({.body = "[]"}, true);
  EXPECT_EQ(
      head,
      "HTTP/1.1 200 OK\r\n"
      "Date: Fri, 02 Jan 2026 03:04:05 GMT\r\n"
      "Content-Type: application/json\r\n"
      "Content-Security-Policy: default-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n"
      "X-Content-Type-Options: nosniff\r\n"
      "X-Frame-Options: DENY\r\n"
      "Referrer-Policy: no-referrer\r\n"
      "Cross-Origin-Resource-Policy: same-origin\r\n"
      "Cache-Control: no-store\r\n"
      "Content-Length: 2\r\n"
      "Connection: keep-alive\r\n\r\n");
  EXPECT_THAT(word_head(refusal(503, "busy"), false), HasSubstr("503 Service Unavailable\r\n"));
  EXPECT_THAT(word_head(refusal(503, "busy"), false), HasSubstr("\r\nConnection: close\r\n"));
  EXPECT_THAT(word_head(too_much("busy"), false), HasSubstr("\r\nRetry-After: 5\r\n"));
  EXPECT_THAT(word_head({.status = 503}, true), Not(HasSubstr("Retry-After"))) << "/health knows of no such time";
  EXPECT_THAT(head, Not(HasSubstr("Server")));
}

TEST(HttpWire, ThePageLoadsWhatThisServerHasAndNothingElse) {
  const support::HandDrivenLoop loop;
  EXPECT_THAT(word_head({.type = "text/html; charset=utf-8", .body = "x", .page = true}, true),
              HasSubstr("\r\nContent-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; "
                        "img-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; "
                        "frame-ancestors 'none'\r\n"));
}

TEST(HttpRefusal, SaysWhatThereIs) {
  const std::vector<std::string> known{"fan1", "pump1"};
  EXPECT_EQ(refusal(404, "there is no \"x\"", "drives", known).body,
            R"({"error":"there is no \"x\"","drives":["fan1","pump1"]})");
}

}  // namespace
}  // namespace gateway::http
