// Any bytes that a client may send to the HTTP server, in any pieces. Whatever they are: what comes back is a row of
// whole answers; only GET and HEAD for this machine reach what answers them; each of them is answered once; nothing
// comes behind an answer that ends the connection; and what is foreign stays out of the headers.
//
// The first byte says how the rest is cut into pieces.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "daemon/http/server.h"
#include "daemon/http/wire.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/http/raw_client.h"

namespace {

using namespace std::chrono_literals;
using gateway::http::Answer;
using gateway::http::Request;

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

/// What the client got.
struct Got {
  std::size_t good = 0;  ///< Answers with status 200.
  bool last = false;     ///< One said that it is the last.
};

// The text of an answer begins with a brace or an x, so that one without a text (of HEAD) can be told.
Got read_answers(std::string_view text) {
  Got got;
  while (!text.empty()) {
    require(!got.last);
    const std::size_t end = text.find("\r\n\r\n");
    require(end != std::string_view::npos && text.starts_with("HTTP/1.1 "));
    const std::string_view head = text.substr(0, end);
    got.good += head.starts_with("HTTP/1.1 200 ") ? 1 : 0;
    got.last = head.find("\r\nConnection: close") != std::string_view::npos;
    constexpr std::string_view kLength = "\r\nContent-Length: ";
    const std::size_t at = head.find(kLength);
    require(at != std::string_view::npos && head.find(kLength, at + 1) == std::string_view::npos);
    const std::size_t length = std::stoul(std::string(head.substr(at + kLength.size(), 10)));
    text.remove_prefix(end + 4);
    if (text.starts_with('{') || text.starts_with('x')) {
      require(text.size() >= length);
      text.remove_prefix(length);
    }
  }
  return got;
}

class Site {
 public:
  Site() {
    settings_.listen.port = 0;
    server_.start();
    loop_.settle();
    require(server_.port() != 0);
  }
  ~Site() {
    const auto stopped = support::spawn(loop_.executor(), server_.stop());
    require(loop_.advance_until([&stopped] { return *stopped; }, 5s));
  }
  Site(const Site&) = delete;
  Site& operator=(const Site&) = delete;

  void send(std::string_view bytes, std::size_t piece) {
    gateway::http::test::RawClient client(server_.port());
    std::string got;
    for (; !bytes.empty() && !client.ended(); bytes.remove_prefix(std::min(piece, bytes.size()))) {
      client.send(bytes.substr(0, piece));
      loop_.settle();
      got += client.received();
    }
    client.end();
    // What loopback carries is there at once, but for a machine that is busy: real time bounds that alone.
    for (const auto limit = std::chrono::steady_clock::now() + 3s;
         !client.ended() && std::chrono::steady_clock::now() < limit;) {
      loop_.settle();
      got += client.received();
    }
    require(client.ended());
    require(client.reset() || read_answers(got).good == answered_);
  }

 private:
  Answer respond(const Request& request) {
    require(request.target.path.starts_with('/'));
    require(gateway::http::host_of(request.host).has_value());
    ++answered_;
    return {.body = "x" + request.target.path};
  }

  support::HandDrivenLoop loop_;
  config::Http settings_;
  std::size_t answered_ = 0;
  gateway::http::Server server_{
      loop_.executor(), settings_, [this](const Request& request) { return respond(request); }, {}, net::Notices{}};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const std::string text(data + 1, data + size);
  Site site;
  site.send(text, data[0] == 0 ? std::max<std::size_t>(text.size(), 1) : data[0]);
  return 0;
}
