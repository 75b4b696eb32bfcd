#include "bridges/mqtt/outbox.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bridges/mqtt/traffic.h"
#include "tests/unit/mqtt/messages.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::alarm;
using test::answer;
using test::status;
using test::value;
using Texts = std::vector<std::string>;

class OutboxTest : public testing::Test {
 protected:
  void push(std::vector<Message> batch) { outbox_.push(std::move(batch), now_); }
  Texts drain() {
    Texts out;
    while (const auto item = outbox_.pop(now_)) {
      out.push_back(item->message.topic + "=" + item->message.payload);
    }
    EXPECT_TRUE(outbox_.empty());
    return out;
  }

  Outbox outbox_;
  Outbox::TimePoint now_{1h};
};

TEST_F(OutboxTest, StatusAlarmsAndAnswersGoBeforeValues) {
  push({value("v", "1"), answer("a"), alarm("x", "on"), status("s", "online")});
  EXPECT_EQ(drain(), (Texts{"s=online", "x=on", "reply=a", "v=1"}));
}

TEST_F(OutboxTest, OfEachTopicTheNewestWaitsInItsPlace) {
  push({value("a", "1")});
  push({value("b", "1"), value("c", "1")});
  push({value("b", "2")});
  push({value("a", "3")});
  EXPECT_EQ(outbox_.size(), 3U);
  EXPECT_EQ(drain(), (Texts{"a=3", "b=2", "c=1"})) << "a topic that changes always cannot starve";
}

TEST_F(OutboxTest, NoTopicStarvesBehindOnesThatAlwaysChange) {
  push({value("a", "0"), value("b", "0"), value("c", "0")});
  Texts left;
  for (int i = 1; i <= 3; ++i) {
    left.push_back(outbox_.pop(now_)->message.topic);
    push({value("a", std::to_string(i)), value("b", std::to_string(i))});
  }
  EXPECT_EQ(left, (Texts{"a", "b", "c"}));
}

TEST_F(OutboxTest, APulseOfOneBatchIsToldWhereNothingWaited) {
  push({value("p", "true"), value("v", "1"), value("p", "false")});
  EXPECT_EQ(drain(), (Texts{"p=true", "p=false", "v=1"}));
}

TEST_F(OutboxTest, ALaterBatchTakesThePlaceOfAPulse) {
  push({value("p", "true"), value("p", "false")});
  push({value("p", "true")});
  EXPECT_EQ(drain(), (Texts{"p=true"}));
  push({value("p", "1"), value("p", "2")});
  EXPECT_EQ(outbox_.pop(now_)->message.payload, "1");
  push({value("p", "3")});
  EXPECT_EQ(drain(), (Texts{"p=3"})) << "of what is left too";
}

TEST_F(OutboxTest, WhereSomethingWaitedAPulseIsOneMessage) {
  push({value("p", "false")});
  push({value("p", "true")});
  push({value("p", "x")});
  EXPECT_EQ(drain(), (Texts{"p=x"}));
}

TEST_F(OutboxTest, OnlineLeavesWhenAllThatWaitsWithItHasLeft) {
  push({value("info", "1"), status("pump1", "online"), alarm("x", "off"), answer("a"), status("B", "online", true)});
  push({alarm("y", "on"), value("info", "2"), status("pump2", "online")});
  EXPECT_EQ(drain(), (Texts{"pump1=online", "pump2=online", "x=off", "y=on", "reply=a", "info=2", "B=online"}));
}

TEST_F(OutboxTest, OnlineDoesNotWaitForWhatCameLater) {
  push({status("B", "online", true)});
  push({value("v", "1")});
  EXPECT_EQ(drain(), (Texts{"B=online", "v=1"}));
}

TEST_F(OutboxTest, OnlineWaitsForAllOfItsBatchWhereItWaitedAlready) {
  outbox_.forget_retained();
  push({status("B", "online"), value("v", "1")});  // behind the break, which is not known yet
  push({value("info", "1"), value("v", "2"), status("B", "online", true)});
  EXPECT_EQ(drain(), (Texts{"v=2", "info=1", "B=online"}));
  push({value("v", "1"), status("B", "online", true)});
  push({value("v", "2"), value("w", "1"), status("B", "online", true)});
  EXPECT_EQ(drain(), (Texts{"v=2", "w=1", "B=online"}));
}

TEST_F(OutboxTest, WhatReplacesOnlineWaitsNoLessAndNoLonger) {
  push({value("v", "1"), status("B", "online", true)});
  push({value("w", "1"), status("B", "online")});
  EXPECT_EQ(drain(), (Texts{"v=1", "B=online", "w=1"}));
  push({value("v", "1"), status("B", "online")});
  EXPECT_EQ(drain(), (Texts{"B=online", "v=1"})) << "only what says so goes after all";
}

TEST_F(OutboxTest, TheLastWordComesLast) {
  push({value("x", "1"), status("B", "online")});
  push({value("v", "null"), status("pump1", "offline"), status("B", "offline", true)});
  EXPECT_EQ(drain(), (Texts{"pump1=offline", "x=1", "v=null", "B=offline"}));
}

TEST_F(OutboxTest, WhatIsNextIsKnownBefore) {
  EXPECT_EQ(outbox_.front(now_), nullptr);
  push({answer("old"), status("B", "online", true), value("v", "1")});
  EXPECT_EQ(outbox_.front(now_)->payload, "old");
  now_ += Outbox::kAnswerAge + 1ms;
  EXPECT_EQ(outbox_.front(now_)->payload, "online") << "an answer that is too old is none";
  EXPECT_EQ(outbox_.pop(now_)->message.payload, "online");
  EXPECT_EQ(outbox_.size(), 1U);
}

TEST_F(OutboxTest, ATopicThatChangesItsKindKeepsItsPlace) {
  push({value("a", "1"), value("b", "1")});
  push({status("b", "2")});
  EXPECT_EQ(drain(), (Texts{"b=2", "a=1"}));
}

TEST_F(OutboxTest, AnAnswerIsDroppedWhenItIsTooOld) {
  push({answer("1")});
  now_ += Outbox::kAnswerAge;
  push({answer("2")});
  now_ += 1ms;
  EXPECT_EQ(drain(), (Texts{"reply=2"}));
  EXPECT_EQ(outbox_.answers_dropped(), 1U);
}

TEST_F(OutboxTest, AnAnswerIsTriedOnTwoConnections) {
  push({answer("1"), answer("2")});
  auto first = outbox_.pop(now_);
  ASSERT_TRUE(first);
  outbox_.put_back(std::move(*first), now_);
  EXPECT_EQ(outbox_.size(), 2U);
  first = outbox_.pop(now_);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->message.payload, "1") << "in its place";
  outbox_.put_back(std::move(*first), now_);
  EXPECT_EQ(outbox_.answers_dropped(), 1U);
  EXPECT_EQ(drain(), (Texts{"reply=2"}));
}

TEST_F(OutboxTest, AnAnswerThatComesBackTooLateIsDropped) {
  push({answer("1")});
  auto item = outbox_.pop(now_);
  ASSERT_TRUE(item);
  outbox_.put_back(std::move(*item), now_ + Outbox::kAnswerAge + 1ms);
  EXPECT_TRUE(outbox_.empty());
  EXPECT_EQ(outbox_.answers_dropped(), 1U);
}

TEST_F(OutboxTest, OfTooManyAnswersTheOldestAreDropped) {
  for (std::size_t i = 0; i < Outbox::kMaxAnswers + 3; ++i) {
    push({answer(std::to_string(i))});
  }
  EXPECT_EQ(outbox_.answers_dropped(), 3U);
  EXPECT_EQ(outbox_.pop(now_)->message.payload, "3");
}

TEST_F(OutboxTest, AnswersAreBoundedInBytesWithTheirCorrelationData) {
  for (int i = 0; i < 10; ++i) {
    Message big = answer(std::to_string(i));
    big.correlation = std::string(1024UL * 1024, 'x');
    push({big});
  }
  EXPECT_EQ(outbox_.size(), 3U);
  EXPECT_EQ(drain(), (Texts{"reply=7", "reply=8", "reply=9"}));
  push({answer("small")});
  EXPECT_EQ(drain(), (Texts{"reply=small"})) << "their bytes are free again";
}

TEST_F(OutboxTest, WithTheConnectionGoesWhatIsRetainedButNoAnswer) {
  push({value("v", "1"), alarm("x", "on"), answer("a"), status("B", "online", true)});
  outbox_.forget_retained();
  EXPECT_EQ(outbox_.size(), 1U);
  push({value("v", "2"), status("B", "online", true)});
  EXPECT_EQ(drain(), (Texts{"reply=a", "v=2", "B=online"}));
}

TEST_F(OutboxTest, StaysBoundedHoweverMuchComes) {
  for (int i = 0; i < 20'000; ++i) {
    push(
        {value("t" + std::to_string(i % 50), std::to_string(i)), alarm("x" + std::to_string(i % 5), "1"), answer("a")});
  }
  EXPECT_EQ(outbox_.size(), Outbox::kMaxAnswers + 55U);
}

TEST(PacketSize, IsThatOfTheStandard) {
  // MQTT 3.1.1 §3.3: 2 of header, 2 + topic, 2 of identifier, payload.
  EXPECT_EQ(packet_size({.topic = "ab", .payload = "xyz"}, 4, 1), 2U + 4U + 2U + 3U);
  EXPECT_EQ(packet_size({.topic = "ab", .payload = "xyz"}, 4, 0), 2U + 4U + 3U);
  // MQTT 5 §3.3: the length of the properties besides; message expiry is 5, correlation data 3 and its bytes.
  EXPECT_EQ(packet_size({.topic = "ab", .payload = "xyz"}, 5, 1), 2U + 4U + 2U + 1U + 3U);
  EXPECT_EQ(packet_size({.topic = "ab", .payload = "xyz", .expiry = 60}, 5, 1), 2U + 4U + 2U + 1U + 5U + 3U);
  EXPECT_EQ(packet_size({.topic = "ab", .payload = "xyz", .correlation = std::string(125, 'c')}, 5, 1),
            3U + 4U + 2U + 2U + 128U + 3U)
      << "both lengths take two bytes";
  EXPECT_EQ(packet_size({.topic = "ab", .payload = std::string(121, 'x')}, 4, 1), 2U + 127U + 0U);
  EXPECT_EQ(packet_size({.topic = "ab", .payload = std::string(122, 'x')}, 4, 1), 3U + 128U);
}

}  // namespace
}  // namespace mqtt
