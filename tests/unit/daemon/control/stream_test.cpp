// Streams of the control socket: one that a test makes, then `trace` and the watched `status` of a gateway.

#include <gmock/gmock.h>

#include <list>
#include <memory>
#include <string>
#include <vector>

#include "daemon/control/server.h"
#include "daemon/temporary_directory.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/control/raw_client.h"

namespace gateway::control {
namespace {

using namespace std::chrono_literals;
using test::RawClient;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// What the streams of a test tell, and how many there are.
struct Source {
  std::string line{};  ///< Each tells it when asked.
  bool more = false;
  std::size_t told = 0;  ///< Pieces.
  int open = 0;
};

class MadeStream final : public Stream {
 public:
  explicit MadeStream(Source& source) : source_(source) { ++source_.open; }
  ~MadeStream() override { --source_.open; }
  bool take(std::string& lines) override {
    ++source_.told;
    lines += source_.line;
    return source_.more;
  }
  canopen::Duration pace() const override { return 50ms; }

 private:
  Source& source_;
};

class ControlStream : public testing::Test {
 protected:
  ControlStream() {
    server_.start();
    loop_.settle();
  }
  ~ControlStream() override { end(); }

  void end() {
    const auto stopped = support::spawn(loop_.executor(), server_.stop(100ms));
    EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, 1s)) << "it does not end";
  }
  RawClient& connect() {
    RawClient& client = clients_.emplace_back(path_);
    loop_.settle();
    return client;
  }
  std::vector<std::string> ask(RawClient& client, std::string_view text) {
    EXPECT_EQ(client.send(text), text.size());
    loop_.settle();
    return client.lines();
  }
  boost::asio::awaitable<std::string> answer(Asked asked) { co_return "{\"id\":" + asked.id + "}"; }

  support::HandDrivenLoop loop_;
  TemporaryDirectory directory_;
  std::filesystem::path path_ = directory_.path() / "control";
  Source source_;
  std::list<RawClient> clients_;
  Server server_{loop_.executor(), Place{path_, ""},
                 Service{.is_stop = [](const Request&) { return false; },
                         .answer = [this](Asked asked) { return answer(std::move(asked)); },
                         .open_stream = [this](const Request& request,
                                               const std::string&) -> canopen::Result<std::unique_ptr<Stream>> {
                           if (request.names == "nobody") {
                             return canopen::Error{.kind = canopen::ErrorKind::unknown, .detail = "no nobody"};
                           }
                           return std::make_unique<MadeStream>(source_);
                         }},
                 Server::Notices{.warning = [](const std::string&) {}, .info = [](const std::string&) {}}};
};

const std::string kTrace = "{\"id\":7,\"op\":\"trace\"}\n";
const std::string kBegun = "{\"id\":7,\"ok\":true,\"stream\":true}";

TEST_F(ControlStream, ItsLinesComeBesideAnswersUntilTheGatewayEnds) {
  RawClient& client = connect();
  source_.line = "{\"id\":7,\"a\":1}\n";
  EXPECT_THAT(ask(client, kTrace), ElementsAre(kBegun, "{\"id\":7,\"a\":1}"));
  EXPECT_THAT(ask(client, "{\"id\":8,\"op\":\"status\"}\n"), ElementsAre("{\"id\":8}"));
  loop_.advance(49ms);
  EXPECT_THAT(client.lines(), IsEmpty());
  loop_.advance(1ms);
  EXPECT_THAT(client.lines(), ElementsAre("{\"id\":7,\"a\":1}"));
  server_.close();
  loop_.settle();
  EXPECT_THAT(client.lines(), ElementsAre("{\"id\":7,\"end\":true,\"reason\":\"the gateway ends\"}"));
  EXPECT_EQ(source_.open, 0);
}

TEST_F(ControlStream, OneAtATimeOfAConnection) {
  RawClient& client = connect();
  EXPECT_THAT(ask(client, kTrace), ElementsAre(kBegun));
  EXPECT_THAT(ask(client, "{\"id\":9,\"op\":\"status\",\"watch\":true}\n"),
              ElementsAre(HasSubstr("{\"id\":9,\"ok\":false,\"code\":\"forbidden\"")));
  EXPECT_THAT(ask(connect(), "{\"id\":7,\"op\":\"trace\",\"names\":\"nobody\"}\n"),
              ElementsAre(AllOf(HasSubstr("\"ok\":false"), HasSubstr("no nobody"))));
  EXPECT_EQ(source_.open, 1);
}

TEST_F(ControlStream, EndsWithItsClientThoughNothingIsToldToIt) {
  RawClient& client = connect();
  RawClient& half = connect();
  EXPECT_THAT(ask(client, kTrace), ElementsAre(kBegun));
  EXPECT_THAT(ask(half, kTrace), ElementsAre(kBegun));
  half.end();
  client.close();
  loop_.advance(100ms);
  EXPECT_EQ(source_.open, 1) << "who only ceased to send reads on";
  EXPECT_EQ(server_.clients(), 1U);
}

// Who does not read is asked no more of the source; nothing grows, and everybody else goes on.
TEST_F(ControlStream, ASlowReaderIsToldNothingFurtherAndDelaysNobody) {
  RawClient& slow = connect();
  source_.line = "{\"id\":7,\"filling\":\"" + std::string(16'000, 'x') + "\"}\n";
  EXPECT_EQ(slow.send(kTrace), kTrace.size());
  loop_.advance(10s, 10ms);
  const std::size_t told = source_.told;
  EXPECT_LT(told * source_.line.size(), Connection::kMaxWaiting) << "the kernel's buffer, and a little of ours";
  loop_.advance(10s, 10ms);
  EXPECT_EQ(source_.told, told);
  EXPECT_THAT(ask(connect(), "{\"id\":8,\"op\":\"status\"}\n"), ElementsAre("{\"id\":8}"));
  EXPECT_FALSE(slow.ended());
  std::size_t lines = 0;
  for (int i = 0; i < 1000 && source_.told < told + 10; ++i) {
    lines += slow.lines().size();
    loop_.advance(50ms, 10ms);
  }
  EXPECT_GE(source_.told, told + 10) << "it goes on once it reads";
  EXPECT_GE(lines, told);
}

// The status of a large plant: it goes where nothing else waits, and answers have their room beside it.
TEST_F(ControlStream, ALineLongerThanWhatMayWaitClosesNothing) {
  RawClient& client = connect();
  source_.line = "{\"id\":7,\"filling\":\"" + std::string(2 * Connection::kMaxWaiting, 'x') + "\"}\n";
  EXPECT_EQ(client.send(kTrace), kTrace.size());
  loop_.advance(1s, 50ms);
  EXPECT_EQ(source_.told, 1U) << "the next one only once this has left";
  EXPECT_GT(client.send("{\"id\":8,\"op\":\"status\"}\n"), 0U);
  loop_.settle();
  std::vector<std::string> lines;
  for (int i = 0; i < 1000 && lines.size() < 3; ++i) {
    source_.line.clear();
    for (std::string& line : client.lines()) {
      lines.push_back(std::move(line));
    }
    loop_.settle();
  }
  EXPECT_FALSE(client.ended());
  EXPECT_THAT(lines, ElementsAre(kBegun, SizeIs(testing::Gt(2 * Connection::kMaxWaiting)), "{\"id\":8}"));
}

TEST_F(ControlStream, ItsIdIsShortSinceEachLineHasIt) {
  RawClient& client = connect();
  const std::string longer(Connection::kMaxStreamId - 1, 'i');
  EXPECT_THAT(ask(client, "{\"id\":\"" + longer + "\",\"op\":\"trace\"}\n"),
              ElementsAre(AllOf(HasSubstr(longer), HasSubstr("\"code\":\"type\""), HasSubstr("longer than 64 bytes"))));
  EXPECT_EQ(source_.open, 0);
  EXPECT_THAT(ask(client, "{\"id\":\"" + longer + "\",\"op\":\"set\",\"drive\":\"a\",\"values\":{\"b\":1}}\n"),
              ElementsAre(HasSubstr(longer)))
      << "an answer has it once";
  EXPECT_THAT(ask(client, "{\"id\":\"" + longer.substr(1) + "\",\"op\":\"trace\"}\n"),
              ElementsAre(HasSubstr("\"stream\":true")));
}

TEST_F(ControlStream, MakesRoomForWhoeverComes) {
  for (std::size_t i = 0; i < Server::kMaxClients; ++i) {
    EXPECT_THAT(ask(connect(), kTrace), ElementsAre(kBegun));
  }
  EXPECT_THAT(ask(connect(), "{\"id\":8,\"op\":\"status\"}\n"), ElementsAre("{\"id\":8}")) << "a stop, for example";
  EXPECT_EQ(server_.clients(), Server::kMaxClients);
}

TEST_F(ControlStream, ASourceThatNeverEndsLetsOthersHaveTheLoop) {
  source_.line = "{\"id\":7}\n";
  source_.more = true;
  RawClient& client = connect();
  EXPECT_EQ(client.send(kTrace), kTrace.size());
  for (int i = 0; i < 200; ++i) {
    loop_.context().poll_one();
  }
  EXPECT_LE(source_.told, 100U) << "a piece, then the turn of the loop";
  source_.more = false;
  loop_.settle();
}

}  // namespace
}  // namespace gateway::control
