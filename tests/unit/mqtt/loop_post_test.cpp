#include "bridges/mqtt/loop_post.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "tests/support/hand_driven_loop.h"

namespace mqtt {
namespace {

class LoopPostTest : public testing::Test {
 protected:
  void TearDown() override { post_->close(); }

  /// Posts a call that says so.
  void post(std::string text) {
    post_->post([this, said = std::move(text)] { received_.emplace_back(said); });
  }

  support::HandDrivenLoop loop_;
  std::vector<std::variant<std::string, Incoming>> received_;
  std::shared_ptr<LoopPost> post_ = std::make_shared<LoopPost>(
      loop_.executor(), [this](Incoming&& message) { received_.emplace_back(std::move(message)); },
      [this](Level, std::string text) { received_.emplace_back(std::move(text)); });
};

TEST_F(LoopPostTest, BringsEventsInOrderAndOnlyOnTheLoop) {
  post("connected");
  post_->post_message(Incoming{.topic = "a"});
  post("disconnected");
  EXPECT_TRUE(received_.empty());
  loop_.settle();
  ASSERT_EQ(received_.size(), 3U);
  EXPECT_EQ(std::get<std::string>(received_[0]), "connected");
  EXPECT_EQ(std::get<Incoming>(received_[1]).topic, "a");
  EXPECT_EQ(std::get<std::string>(received_[2]), "disconnected");
}

TEST_F(LoopPostTest, TakesEventsFromOtherThreads) {
  std::thread other([this] {
    for (int i = 0; i < 100; ++i) {
      post_->post_message(Incoming{.topic = std::to_string(i)});
    }
  });
  other.join();
  loop_.settle();
  EXPECT_EQ(received_.size(), 100U);
}

TEST_F(LoopPostTest, CountsCommandsThatComeTooFast) {
  for (std::size_t i = 0; i < LoopPost::kMaxMessages + 5; ++i) {
    post_->post_message(Incoming{.topic = "t"});
  }
  post("disconnected");
  loop_.settle();
  ASSERT_EQ(received_.size(), LoopPost::kMaxMessages + 2);
  EXPECT_NE(std::get<std::string>(received_.back()).find("5 commands"), std::string::npos);
  received_.clear();
  post_->post_message(Incoming{.topic = "t"});
  loop_.settle();
  EXPECT_EQ(received_.size(), 1U);
}

TEST_F(LoopPostTest, IsBoundedInBytesToo) {
  for (int i = 0; i < 10; ++i) {
    post_->post_message(Incoming{.payload = std::string(1024UL * 1024, 'x')});
  }
  loop_.settle();
  EXPECT_EQ(received_.size(), 5U) << "four messages and the notice";
}

TEST_F(LoopPostTest, CountsAllThatAMessageHolds) {
  for (int i = 0; i < 10; ++i) {
    post_->post_message(
        Incoming{.response_topic = std::string(512UL * 1024, 'x'), .correlation = std::string(512UL * 1024, 'x')});
  }
  loop_.settle();
  EXPECT_EQ(received_.size(), 5U) << "four messages and the notice";
}

TEST_F(LoopPostTest, AStopIsNotLostInAFlood) {
  post_->tell_stops_by([](const Incoming& message) { return message.payload == "stop"; });
  for (std::size_t i = 0; i < LoopPost::kMaxMessages + 500; ++i) {
    post_->post_message(Incoming{.topic = "pump1", .payload = "run"});
  }
  post_->post_message(Incoming{.topic = "pump1", .payload = "stop"});
  for (int i = 0; i < 500; ++i) {
    post_->post_message(Incoming{.topic = "pump1", .payload = "run"});
  }
  loop_.settle();
  ASSERT_EQ(received_.size(), LoopPost::kMaxMessages + 2);
  EXPECT_EQ(std::get<Incoming>(received_[LoopPost::kMaxMessages]).payload, "stop");
  EXPECT_NE(std::get<std::string>(received_.back()).find("1000 commands"), std::string::npos);
}

TEST_F(LoopPostTest, NothingGoesBehindACommandThatWasDroppedButStops) {
  post_->tell_stops_by([](const Incoming& message) { return message.payload == "stop"; });
  post_->post_message(Incoming{.payload = std::string(LoopPost::kMaxBytes, 'x')});
  post_->post_message(Incoming{.topic = "pump1", .payload = "run"});
  post_->post_message(Incoming{.topic = "pump1", .payload = "stop"});
  post_->post_message(Incoming{});
  loop_.settle();
  ASSERT_EQ(received_.size(), 3U);
  EXPECT_EQ(std::get<Incoming>(received_[1]).payload, "stop");
  EXPECT_NE(std::get<std::string>(received_[2]).find("2 commands"), std::string::npos)
      << "the empty one too, though it would fit: it came later";
}

TEST_F(LoopPostTest, OfAFloodOfStopsEachTopicKeepsOne) {
  post_->tell_stops_by([](const Incoming& message) { return message.payload == "stop"; });
  for (std::size_t i = 0; i < LoopPost::kMaxMessages * 3; ++i) {
    post_->post_message(Incoming{.topic = "pump1", .payload = "stop"});
  }
  post_->post_message(Incoming{.topic = "fan1", .payload = "stop"});
  loop_.settle();
  ASSERT_EQ(received_.size(), LoopPost::kMaxMessages * 2 + 2);
  EXPECT_EQ(std::get<Incoming>(received_[LoopPost::kMaxMessages * 2]).topic, "fan1");
  EXPECT_NE(std::get<std::string>(received_.back()).find("1000 commands"), std::string::npos);
  received_.clear();
  post_->post_message(Incoming{.topic = "pump1", .payload = "run"});
  loop_.settle();
  EXPECT_EQ(received_.size(), 1U) << "all room is there again";
}

TEST_F(LoopPostTest, WhatIsWatchedCostsNoCommandItsPlaceAndIsTheNewestOfItsTopic) {
  for (std::size_t i = 0; i < LoopPost::kMaxMessages * 3; ++i) {
    post_->post_watched(Incoming{.topic = "alarm", .payload = std::to_string(i)});
  }
  for (std::size_t i = 0; i < LoopPost::kMaxMessages; ++i) {
    post_->post_message(Incoming{.topic = "pump1", .payload = "run"});
  }
  post_->post_watched(Incoming{.topic = "alarm", .payload = "newest"});
  loop_.settle();
  ASSERT_EQ(received_.size(), LoopPost::kMaxMessages + 1) << "no command was dropped, and so nothing said";
  EXPECT_EQ(std::get<Incoming>(received_[0]).payload, "newest");
  post_->post_watched(Incoming{.topic = "alarm", .payload = "again"});
  loop_.settle();
  EXPECT_EQ(std::get<Incoming>(received_.back()).payload, "again");
}

TEST_F(LoopPostTest, AllThatTheBrokerKeepsOfALargePlantComesInOneTurn) {
  for (std::size_t i = 0; i < 5000; ++i) {
    post_->post_watched(Incoming{.topic = std::to_string(i), .payload = "50.00"});
  }
  loop_.settle();
  EXPECT_EQ(received_.size(), 5000U);
}

TEST_F(LoopPostTest, WhatIsWatchedIsBoundedInTopicsAndBytes) {
  for (std::size_t i = 0; i < LoopPost::kMaxTopics + 5; ++i) {
    post_->post_watched(Incoming{.topic = std::to_string(i), .payload = std::string(64UL * 1024, 'x')});
  }
  post_->post_watched(Incoming{.topic = "0", .payload = std::string(LoopPost::kMaxBytes, 'y')});
  loop_.settle();
  ASSERT_EQ(received_.size(), LoopPost::kMaxTopics);
  std::size_t bytes = 0;
  for (const auto& event : received_) {
    bytes += std::get<Incoming>(event).payload.size();
  }
  EXPECT_LE(bytes, LoopPost::kMaxBytes);
  EXPECT_GT(bytes, LoopPost::kMaxBytes / 2);
  EXPECT_EQ(std::get<Incoming>(received_[0]).payload, "") << "told, though without its payload";
}

TEST_F(LoopPostTest, AStopThatComesByWhatIsWatchedIsReplacedByNothing) {
  post_->tell_stops_by([](const Incoming& message) { return message.payload == "stop"; });
  for (const char* payload : {"stop", "run", "walk"}) {
    post_->post_watched(Incoming{.topic = "pump1", .payload = payload});
  }
  loop_.settle();
  ASSERT_EQ(received_.size(), 2U);
  EXPECT_EQ(std::get<Incoming>(received_[0]).payload, "stop");
  EXPECT_EQ(std::get<Incoming>(received_[1]).payload, "walk");
}

TEST_F(LoopPostTest, BringsNothingAfterItWasClosed) {
  post("disconnected");
  post_->close();
  post("disconnected");
  loop_.settle();
  EXPECT_TRUE(received_.empty());
}

}  // namespace
}  // namespace mqtt
