#include "bridges/mqtt/outbox.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mqtt {
namespace {

Message value(std::string topic, std::string payload) {
  return {.topic = std::move(topic), .payload = std::move(payload)};
}
Message alarm(std::string topic, std::string payload) {
  return {.topic = std::move(topic), .payload = std::move(payload), .kind = MessageKind::alarm};
}
Message answer(std::string payload) {
  return {.topic = "reply", .payload = std::move(payload), .kind = MessageKind::answer, .retained = false};
}

std::vector<std::string> drain(Outbox& outbox) {
  std::vector<std::string> out;
  while (const auto message = outbox.pop()) {
    out.push_back(message->topic + "=" + message->payload);
  }
  return out;
}

using Texts = std::vector<std::string>;

TEST(Outbox, KeepsEveryMessageInOrder) {
  Outbox outbox(10);
  outbox.push(value("a", "1"));
  outbox.push(value("b", "1"));
  outbox.push(value("a", "2"));
  EXPECT_EQ(drain(outbox), (Texts{"a=1", "b=1", "a=2"}));
  EXPECT_TRUE(outbox.empty());
}

TEST(Outbox, OverItsLimitKeepsTheNewestPerTopicInItsPlace) {
  Outbox outbox(3);
  outbox.push(value("a", "1"));
  outbox.push(value("a", "2"));
  outbox.push(value("b", "1"));
  outbox.push(value("a", "3"));
  outbox.push(value("b", "2"));
  outbox.push(value("c", "1"));  // a topic that is not there yet is never refused
  EXPECT_EQ(drain(outbox), (Texts{"a=1", "a=3", "b=2", "c=1"}));
}

TEST(Outbox, StaysBoundedHoweverMuchComes) {
  Outbox outbox(100);
  for (int i = 0; i < 100'000; ++i) {
    outbox.push(value("t" + std::to_string(i % 50), std::to_string(i)));
    outbox.push(alarm("alarm" + std::to_string(i % 5), std::to_string(i)));
    outbox.push(answer(std::to_string(i)));
  }
  EXPECT_LE(outbox.size(), 3U * 100U + 55U);
}

TEST(Outbox, AFloodOfValuesCostsNeitherAlarmsNorAnswers) {
  Outbox outbox(4);
  outbox.push(alarm("alarm", "on"));
  outbox.push(answer("1"));
  for (int i = 0; i < 1000; ++i) {
    outbox.push(value("v", std::to_string(i)));
  }
  outbox.push(alarm("alarm", "off"));
  outbox.push(answer("2"));
  EXPECT_EQ(drain(outbox), (Texts{"alarm=on", "reply=1", "v=0", "v=1", "v=2", "v=999", "alarm=off", "reply=2"}));
  EXPECT_EQ(outbox.lost_answers(), 0U);
}

TEST(Outbox, OfTooManyAnswersTheOldestIsLostAndCounted) {
  Outbox outbox(2);
  outbox.push(answer("1"));
  outbox.push(value("v", "0"));
  outbox.push(answer("2"));
  outbox.push(answer("3"));
  EXPECT_EQ(outbox.lost_answers(), 1U);
  EXPECT_EQ(drain(outbox), (Texts{"v=0", "reply=2", "reply=3"}));
}

TEST(Outbox, WhileHeldKeepsTheNewestPerTopicAndEveryAnswer) {
  Outbox outbox(10);
  outbox.push(value("a", "1"));
  outbox.push(answer("1"));
  outbox.push(value("a", "2"));
  outbox.push(alarm("x", "on"));
  outbox.hold(true);
  outbox.push(value("a", "3"));
  outbox.push(alarm("x", "off"));
  outbox.push(answer("1"));
  EXPECT_EQ(drain(outbox), (Texts{"reply=1", "a=3", "x=off", "reply=1"}));
  outbox.hold(false);
  outbox.push(value("a", "4"));
  outbox.push(value("a", "5"));
  EXPECT_EQ(drain(outbox), (Texts{"a=4", "a=5"}));
}

TEST(Outbox, WhatIsAnnouncedAgainKeepsItsNewOrder) {
  Outbox outbox(10);
  outbox.push(value("info", "1"));
  outbox.push(value("drive", "on"));
  outbox.push(value("status", "online"));
  EXPECT_EQ(outbox.pop()->topic, "info");  // then the connection breaks
  outbox.hold(true);
  outbox.push(value("info", "2"));
  outbox.push(value("drive", "off"));
  outbox.push(value("status", "online"));
  EXPECT_EQ(drain(outbox), (Texts{"info=2", "drive=off", "status=online"})) << "the gateway's status comes last";
}

TEST(Outbox, AnAnswerThatWasUnderWayGoesFirst) {
  Outbox outbox(2);
  outbox.push(answer("2"));
  outbox.put_back(answer("1"));
  EXPECT_EQ(outbox.size(), 2U);
  outbox.put_back(answer("0"));
  EXPECT_EQ(outbox.lost_answers(), 1U);
  EXPECT_EQ(drain(outbox), (Texts{"reply=1", "reply=2"}));
}

}  // namespace
}  // namespace mqtt
