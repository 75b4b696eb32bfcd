#include "bridges/mqtt/status_topic.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

class StatusTopicTest : public testing::Test {
 protected:
  /// What is published when it is asked at this time.
  std::vector<std::string> collect(bool online, canopen::TimePoint now) {
    std::vector<Message> out;
    topic_.collect(online, now, out);
    std::vector<std::string> payloads;
    for (const Message& message : out) {
      EXPECT_EQ(message.topic, "B/status");
      EXPECT_EQ(message.kind, MessageKind::status);
      EXPECT_EQ(message.expiry, message.payload == "online" ? 90U : 0U);
      payloads.push_back(message.payload);
    }
    return payloads;
  }

  using Payloads = std::vector<std::string>;
  static config::Mqtt settings_of() {
    config::Mqtt settings;
    settings.expiry = 90s;
    return settings;
  }
  const std::string name_ = "B/status";
  const config::Mqtt settings_ = settings_of();
  StatusTopic topic_{name_, settings_};
  const canopen::TimePoint start_{1h};
};

TEST_F(StatusTopicTest, IsToldAtFirstAtEachChangeAndBeforeItExpires) {
  EXPECT_EQ(collect(true, start_), Payloads{"online"});
  EXPECT_EQ(collect(true, start_ + 1s), Payloads{});
  EXPECT_EQ(topic_.next(), start_ + 30s);
  EXPECT_EQ(collect(true, start_ + 30s), Payloads{"online"});
  EXPECT_EQ(collect(false, start_ + 31s), Payloads{"offline"});
  EXPECT_EQ(topic_.next(), canopen::kNever) << "offline does not expire";
  EXPECT_EQ(collect(true, start_ + 31s), Payloads{"online"});
}

TEST_F(StatusTopicTest, IsPutRightAtMostOnceASecond) {
  EXPECT_EQ(topic_.received("offline", start_), canopen::kNever) << "nothing was said on this connection yet";
  collect(true, start_);
  EXPECT_EQ(topic_.received("offline", start_ + 5s), start_ + 5s);
  EXPECT_EQ(collect(true, start_ + 5s), Payloads{"online"});
  EXPECT_EQ(topic_.received("", start_ + 5100ms), start_ + 6s);
  EXPECT_EQ(collect(true, start_ + 5100ms), Payloads{});
  EXPECT_EQ(collect(true, start_ + 6s), Payloads{"online"});
  EXPECT_EQ(topic_.received("nonsense", start_ + 20s), start_ + 20s);
}

TEST_F(StatusTopicTest, ItsOwnWordThatComesBackIsNoStrangers) {
  collect(true, start_);
  EXPECT_EQ(topic_.received("online", start_ + 10ms), canopen::kNever);
  collect(false, start_ + 10s);
  EXPECT_EQ(topic_.received("online", start_ + 10s + 10ms), start_ + 11s) << "said before, it may come late";
  EXPECT_EQ(topic_.received("offline", start_ + 10s + 20ms), canopen::kNever) << "and so may the last one";
  EXPECT_EQ(topic_.next(), canopen::kNever);
  EXPECT_EQ(topic_.received("online", start_ + 12s), start_ + 12s) << "a stranger's";
}

TEST_F(StatusTopicTest, ANewConnectionHearsItAgain) {
  collect(false, start_);
  topic_.received("online", start_ + 5s);
  topic_.forget();
  EXPECT_EQ(collect(false, start_ + 5s), Payloads{"offline"});
  EXPECT_EQ(topic_.next(), canopen::kNever) << "what was wrong there is forgotten";
}

TEST_F(StatusTopicTest, ForEverNeedsNoRefreshing) {
  config::Mqtt settings = settings_;
  settings.expiry = 0s;
  StatusTopic topic(name_, settings);
  std::vector<Message> out;
  topic.collect(true, start_, out);
  ASSERT_EQ(out.size(), 1U);
  EXPECT_EQ(out[0].expiry, 0U);
  EXPECT_EQ(topic.next(), canopen::kNever);
}

TEST_F(StatusTopicTest, TheFirstOnlineOfAConnectionAndTheLastOfflineGoAfterAllElse) {
  StatusTopic last_word(name_, settings_, true);
  std::vector<Message> out;
  last_word.collect(true, start_, out);
  last_word.collect(true, start_ + 30s, out);
  last_word.forget();
  last_word.collect(true, start_ + 31s, out);
  ASSERT_EQ(out.size(), 3U);
  EXPECT_TRUE(out[0].after_all);
  EXPECT_FALSE(out[1].after_all) << "all else is there: it must not run out while much waits";
  EXPECT_TRUE(out[2].after_all);
  EXPECT_TRUE(last_word.offline().after_all);
  EXPECT_FALSE(topic_.offline().after_all);
}

}  // namespace
}  // namespace mqtt
