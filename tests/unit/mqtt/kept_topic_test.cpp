#include "bridges/mqtt/kept_topic.h"

#include <gtest/gtest.h>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

class KeptTopicTest : public testing::Test {
 protected:
  // As on a connection of some time: `word` was published.
  void publish(const std::string& word, canopen::TimePoint at) {
    topic_.forget();
    ASSERT_TRUE(topic_.offer(word, at));
  }

  KeptTopic topic_;
  const canopen::TimePoint start_{1h};
};

TEST_F(KeptTopicTest, IsDueAtEachNewConnectionWhateverItIs) {
  EXPECT_LE(topic_.next(), start_);
  EXPECT_TRUE(topic_.offer("a", start_));
  EXPECT_EQ(topic_.next(), canopen::kNever);
  topic_.forget();
  EXPECT_LE(topic_.next(), start_);
  EXPECT_TRUE(topic_.offer("a", start_ + 1ms));
  EXPECT_EQ(topic_.next(), canopen::kNever);
}

TEST_F(KeptTopicTest, AChangeIsDueAtOnceAndTheNextOnesAreHeldBack) {
  publish("a", start_ - 10s);
  EXPECT_EQ(topic_.changed(start_), start_);
  EXPECT_TRUE(topic_.offer("b", start_));
  EXPECT_EQ(topic_.changed(start_ + 10ms), start_ + 500ms);
  EXPECT_EQ(topic_.changed(start_ + 20ms), start_ + 500ms);
  EXPECT_EQ(topic_.next(), start_ + 500ms);
  EXPECT_TRUE(topic_.offer("c", start_ + 500ms));
  EXPECT_EQ(topic_.next(), canopen::kNever);
}

TEST_F(KeptTopicTest, TheFirstWordAfterNoneHoldsBackTheNextOnes) {
  topic_.withhold();
  EXPECT_EQ(topic_.changed(start_), start_);
  EXPECT_TRUE(topic_.offer("a", start_));
  EXPECT_EQ(topic_.changed(start_ + 10ms), start_ + 500ms);
}

TEST_F(KeptTopicTest, WithheldNothingIsPutRight) {
  publish("a", start_);
  EXPECT_EQ(topic_.received("b", start_ + 1s), start_ + 1s);
  topic_.withhold();
  EXPECT_EQ(topic_.next(), canopen::kNever);
}

TEST_F(KeptTopicTest, WhatDidNotChangeIsNotPublishedAndHoldsNothingBack) {
  publish("a", start_ - 10s);
  EXPECT_EQ(topic_.changed(start_), start_);
  EXPECT_FALSE(topic_.offer("a", start_));
  EXPECT_EQ(topic_.next(), canopen::kNever);
  EXPECT_EQ(topic_.changed(start_ + 1ms), start_ + 1ms);
  EXPECT_TRUE(topic_.offer("b", start_ + 1ms));
}

TEST_F(KeptTopicTest, ToSayAWordAgainHoldsNoChangeBack) {
  publish("a", start_);
  EXPECT_EQ(topic_.changed(start_ + 1ms), start_ + 1ms) << "after a new connection";
  ASSERT_TRUE(topic_.offer("b", start_ + 1ms));
  topic_.received("x", start_ + 2s);
  ASSERT_TRUE(topic_.offer("b", start_ + 2s));
  EXPECT_EQ(topic_.changed(start_ + 2001ms), start_ + 2001ms) << "after it was put right";
}

TEST_F(KeptTopicTest, WithoutAWordTheTopicStaysAsItIs) {
  topic_.withhold();
  EXPECT_EQ(topic_.next(), canopen::kNever);
  EXPECT_EQ(topic_.received("x", start_), canopen::kNever);
  EXPECT_EQ(topic_.next(), canopen::kNever);
  EXPECT_EQ(topic_.changed(start_), start_);
  EXPECT_TRUE(topic_.offer("a", start_));
}

TEST_F(KeptTopicTest, IsPutRightAtMostOnceASecond) {
  publish("a", start_ - 10s);
  EXPECT_EQ(topic_.received("x", start_), start_);
  EXPECT_TRUE(topic_.offer("a", start_));
  EXPECT_EQ(topic_.next(), canopen::kNever);
  EXPECT_EQ(topic_.received("", start_ + 10ms), start_ + 1s);
  EXPECT_EQ(topic_.received("y", start_ + 20ms), start_ + 1s);
  EXPECT_EQ(topic_.next(), start_ + 1s);
  EXPECT_TRUE(topic_.offer("a", start_ + 1s));
  EXPECT_EQ(topic_.next(), canopen::kNever);
}

TEST_F(KeptTopicTest, WhoeverPutsItRightItIsRight) {
  publish("a", start_ - 10s);
  topic_.received("x", start_);
  EXPECT_EQ(topic_.received("a", start_), canopen::kNever);
  EXPECT_EQ(topic_.next(), canopen::kNever);
  // A new word does so too.
  topic_.received("x", start_);
  topic_.changed(start_);
  EXPECT_TRUE(topic_.offer("b", start_));
  EXPECT_EQ(topic_.next(), canopen::kNever);
}

TEST_F(KeptTopicTest, OwnMessagesThatComeBackAreNoReasonToSayItAgain) {
  publish("a", start_ - 10s);
  topic_.changed(start_);
  ASSERT_TRUE(topic_.offer("b", start_));
  topic_.received("a", start_ + 10ms);  // on its way when `b` was published
  EXPECT_GT(topic_.next(), start_ + 900ms);
  topic_.received("b", start_ + 20ms);
  EXPECT_EQ(topic_.next(), canopen::kNever);
}

TEST_F(KeptTopicTest, AnOlderWordOfOursThatSomebodyWritesIsPutRightToo) {
  publish("a", start_ - 10s);
  topic_.changed(start_ - 5s);
  ASSERT_TRUE(topic_.offer("b", start_ - 5s));
  topic_.received("a", start_);
  EXPECT_LE(topic_.next(), start_ + 1s);
  EXPECT_TRUE(topic_.offer("b", topic_.next()));
}

}  // namespace
}  // namespace mqtt
