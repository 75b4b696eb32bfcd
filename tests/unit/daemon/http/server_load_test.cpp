#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "daemon/http/server.h"
#include "tests/unit/daemon/http/server_site.h"

namespace gateway::http {
namespace {

using namespace std::chrono_literals;
using test::kGet;
using test::RawClient;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;

class HttpLoad : public test::ServerSite {};

TEST_F(HttpLoad, ATurnOfTheLoopTakesOneRequest) {
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

TEST_F(HttpLoad, ATurnOfTheLoopTakesOnePieceOfAnAnswer) {
  pieces_ = 20;
  start();
  RawClient& client = connect();
  client.get("/pieces");
  while (worded_ < 20) {
    const std::size_t before = worded_;
    ASSERT_NE(loop_.context().poll_one(), 0U);
    EXPECT_LE(worded_, before + 1);
  }
  loop_.settle();
  EXPECT_THAT(client.received(),
              AllOf(HasSubstr("\r\nContent-Length: 27\r\n"), EndsWith("/pieces" + std::string(20, 'x'))));
}

TEST_F(HttpLoad, PiecesTakeAQuarterOfTheTimeAndOthersComeBetween) {
  wording_ = 1ms;
  start();
  connect().get("/pieces");
  loop_.settle();
  EXPECT_EQ(worded_, 0U) << "beginning took a millisecond";
  loop_.advance(2ms);
  EXPECT_EQ(worded_, 0U);
  loop_.advance(1ms);
  EXPECT_EQ(worded_, 1U);
  RawClient& other = connect("127.0.0.2");
  other.get("/x");
  loop_.advance(6ms);
  EXPECT_THAT(other.received(), StartsWith("HTTP/1.1 200 "));
  EXPECT_LT(worded_, 3U) << "the long one is not ready";
}

TEST_F(HttpLoad, NothingIsWordedForWhoWaitsWhenTheServerEnds) {
  wording_ = 10ms;
  start();
  for (int i = 0; i < 20; ++i) {
    connect().get("/x");
  }
  loop_.settle();
  ASSERT_THAT(asked_, SizeIs(1)) << "the others wait for their turn";
  end();
  EXPECT_THAT(asked_, SizeIs(1));
}

TEST_F(HttpLoad, NothingMoreIsWordedOfALongAnswerWhenTheServerEnds) {
  wording_ = 10ms;
  start();
  connect().get("/pieces");
  connect().get("/pieces");
  loop_.advance(100ms);
  const std::size_t before = worded_;
  ASSERT_LT(before, 6U);
  end();
  EXPECT_EQ(worded_, before);
}

TEST_F(HttpLoad, WhoWaitsForATurnIsNotTakenForOneThatTakesNothing) {
  wording_ = 10s;
  start();
  connect().get("/x");
  loop_.settle();
  wording_ = 0s;
  RawClient& waits = connect();
  waits.get("/y");
  loop_.advance(29s, 100ms);
  EXPECT_THAT(asked_, SizeIs(1));
  loop_.advance(2s, 100ms);
  EXPECT_THAT(waits.received(), EndsWith("\r\n\r\n/y"));
}

TEST_F(HttpLoad, LargeAnswersThatNobodyTakesAreBoundedForTheirAddress) {
  start();
  for (int i = 0; i < 8; ++i) {
    connect("127.0.0.1", RawClient::Buffers::small).get("/long");
  }
  loop_.settle();
  EXPECT_EQ(server_->figures().answers.at(200), 2U) << "twice 4 MB";
  EXPECT_EQ(server_->figures().answers.at(503), 6U);
  EXPECT_THAT(ask(connect(), kGet), StartsWith("HTTP/1.1 200 ")) << "small answers are always there";
  EXPECT_THAT(ask(connect("127.0.0.2"), "GET /long HTTP/1.1\r\nHost: localhost\r\n\r\n"), StartsWith("HTTP/1.1 200 "));
  loop_.advance(22s, 100ms);
  EXPECT_THAT(ask(connect(), "GET /long HTTP/1.1\r\nHost: localhost\r\n\r\n"), StartsWith("HTTP/1.1 200 "));
}

TEST(HttpWaitingBytes, SmallAnswersAlwaysHaveRoom) {
  WaitingBytes waiting;
  const auto one = boost::asio::ip::make_address("192.0.2.1");
  const auto other = boost::asio::ip::make_address("192.0.2.2");
  EXPECT_TRUE(waiting.has_room(one, 0, WaitingBytes::kMost)) << "a single one may be as large as all";
  EXPECT_FALSE(waiting.has_room(one, 0, WaitingBytes::kMost + 1));
  waiting.add(one, WaitingBytes::kMostOfAddress);
  EXPECT_FALSE(waiting.has_room(one, 0, WaitingBytes::kSmall + 1));
  EXPECT_TRUE(waiting.has_room(one, 0, WaitingBytes::kSmall));
  EXPECT_TRUE(waiting.has_room(one, WaitingBytes::kMostOfAddress, WaitingBytes::kMost)) << "it grows itself";
  EXPECT_TRUE(waiting.has_room(other, 0, WaitingBytes::kMost - WaitingBytes::kMostOfAddress));
  EXPECT_FALSE(waiting.has_room(other, 0, WaitingBytes::kMost));
  waiting.remove(one, WaitingBytes::kMostOfAddress);
  EXPECT_TRUE(waiting.has_room(other, 0, WaitingBytes::kMost));
}

class HttpLoopShare : public testing::Test {
 protected:
  /// Who has the first turn.
  const canopen::Timer* first(const std::vector<const canopen::Timer*>& waiting) {
    for (const canopen::Timer* const timer : waiting) {
      if (share_.when(*timer) != canopen::kNever) {
        return timer;
      }
    }
    return nullptr;
  }

  support::HandDrivenLoop loop_;
  LoopShare share_;
  boost::asio::ip::address here_ = boost::asio::ip::make_address("192.0.2.1");
  boost::asio::ip::address there_ = boost::asio::ip::make_address("192.0.2.2");
};

TEST_F(HttpLoopShare, LeavesThreeQuartersOfTheLoopAndKeepsTheOrder) {
  canopen::Timer one(loop_.executor());
  canopen::Timer other(loop_.executor());
  const canopen::TimePoint begin = canopen::Clock::now();
  share_.enter(one, here_);
  share_.enter(other, here_);
  EXPECT_LT(share_.when(one), begin);
  EXPECT_EQ(share_.when(other), canopen::kNever) << "it came later";
  bool woken = false;
  other.expires_at(share_.when(other));
  other.async_wait([&woken](const boost::system::error_code&) { woken = true; });
  share_.note(begin, begin + 5ms);
  share_.leave(one);
  loop_.settle();
  EXPECT_TRUE(woken);
  EXPECT_EQ(share_.when(other), begin + 20ms);
  share_.leave(other);
}

TEST_F(HttpLoopShare, AddressesHaveTheirTurnsInRotation) {
  canopen::Timer one(loop_.executor());
  canopen::Timer two(loop_.executor());
  canopen::Timer three(loop_.executor());
  canopen::Timer other(loop_.executor());
  share_.enter(one, here_);
  share_.enter(two, here_);
  share_.enter(three, here_);
  share_.enter(other, there_);
  const std::vector<const canopen::Timer*> all{&one, &two, &three, &other};
  EXPECT_EQ(first(all), &one);
  share_.leave(one);
  EXPECT_EQ(first(all), &other) << "it came last, from where nobody else waits";
  share_.leave(other);
  share_.enter(other, there_);
  EXPECT_EQ(first(all), &two) << "and has its next turn after one of theirs";
  share_.leave(two);
  EXPECT_EQ(first(all), &other);
  share_.leave(other);
  EXPECT_EQ(first(all), &three);
  share_.leave(three);
}

}  // namespace
}  // namespace gateway::http
