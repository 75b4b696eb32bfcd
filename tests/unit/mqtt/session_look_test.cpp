// The look through what the broker keeps, before commands are subscribed to.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bridges/mqtt/session.h"
#include "tests/unit/mqtt/fake_broker.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using Phase = Session::Phase;

class SessionLook : public testing::Test {
 protected:
  void connect(ConnectionId connection, canopen::TimePoint at, const std::string& broker = "b:1883") {
    session_.connected({.id = connection, .broker = broker}, at);
  }
  void granted(canopen::TimePoint at) { session_.subscribed({.filter = kTree}, at); }
  bool hears(canopen::TimePoint at, bool retained = true, const std::string& topic = "canopen/line3/pump1/set") {
    return session_.sets_aside({.topic = topic, .payload = "1", .retained = retained}, at);
  }
  /// Filters of all subscriptions of this connection.
  [[nodiscard]] std::vector<std::string> asked() const {
    std::vector<std::string> filters;
    for (const Subscription& each : broker_.subscribed) {
      filters.push_back(each.filter);
    }
    return filters;
  }

  using Filters = std::vector<std::string>;
  static constexpr const char* kTree = "canopen/line3/#";
  config::Model model_ = test::model();
  Topics topics_{model_, *model_.mqtt, "line3"};
  test::FakeBroker broker_;
  std::vector<std::string> notices_;
  Session session_{broker_, topics_, [this](Level, std::string text) { notices_.push_back(std::move(text)); }};
  const canopen::TimePoint start_{1h};
};

TEST_F(SessionLook, EndsWhenNothingKeptHasComeForAWhileAndIsGivenBackBeforeCommands) {
  connect(1, start_);
  EXPECT_EQ(session_.phase(), Phase::looking);
  EXPECT_EQ(asked(), Filters{kTree});
  EXPECT_FALSE(broker_.subscription(kTree).watched) << "what is kept is wanted";
  EXPECT_TRUE(broker_.subscription(kTree).bulk);
  EXPECT_EQ(broker_.subscription(kTree).qos, 0) << "what waits with QoS 1 may come after it was given back";
  granted(start_ + 100ms);
  EXPECT_TRUE(hears(start_ + 400ms)) << "and it is no command";
  EXPECT_TRUE(hears(start_ + 700ms, false)) << "nor is what comes live";
  session_.tick(start_ + 899ms);
  EXPECT_EQ(broker_.unsubscribed, Filters{});
  EXPECT_EQ(session_.deadline(), start_ + 900ms) << "from the last one that was kept";
  session_.tick(start_ + 900ms);
  EXPECT_EQ(session_.phase(), Phase::leaving);
  EXPECT_EQ(broker_.unsubscribed, Filters{kTree});
  EXPECT_EQ(broker_.unsubscribed_on, 1U);
  EXPECT_EQ(asked(), Filters{kTree}) << "no command yet: two subscriptions would bring it twice";
}

TEST_F(SessionLook, CommandsAreSubscribedToWhenTheBrokerHasTakenItBack) {
  session_.unsubscribed(start_);
  connect(1, start_);
  granted(start_);
  session_.unsubscribed(start_);
  EXPECT_EQ(session_.phase(), Phase::looking) << "of nothing that was given back";
  session_.tick(start_ + 500ms);
  EXPECT_TRUE(hears(start_ + 900ms, false)) << "it came by the look, or it would come again";
  session_.tick(start_ + 5s);
  EXPECT_EQ(session_.phase(), Phase::leaving);
  session_.unsubscribed(start_ + 5s);
  EXPECT_EQ(session_.phase(), Phase::subscribing);
  EXPECT_FALSE(hears(start_ + 5s, false)) << "a command from here on";
  EXPECT_EQ(broker_.subscribed.size(), 1 + topics_.command_subscriptions().size());
  EXPECT_TRUE(notices_.empty());
}

TEST_F(SessionLook, IsOverAfterAWhileWhateverComes) {
  connect(1, start_);
  granted(start_);
  for (canopen::Duration passed{}; passed < Session::kSubscribePatience; passed += 100ms) {
    EXPECT_TRUE(hears(start_ + passed));
    session_.tick(start_ + passed);
    EXPECT_EQ(session_.phase(), Phase::looking);
  }
  session_.tick(start_ + Session::kSubscribePatience);
  EXPECT_EQ(session_.phase(), Phase::leaving);
}

TEST_F(SessionLook, ABrokerThatDoesNotTakeItBackGetsAnotherConnection) {
  connect(1, start_);
  granted(start_);
  session_.tick(start_ + 500ms);
  canopen::TimePoint now = start_ + 500ms;
  for (; now < start_ + 500ms + Session::kSubscribePatience; now += 100ms) {
    EXPECT_TRUE(hears(now, false));
    session_.tick(now);
    EXPECT_EQ(broker_.dropped, 0U);
  }
  session_.tick(now);
  EXPECT_EQ(broker_.dropped, 1U);
  EXPECT_NE(broker_.dropped_why.find("does not end the subscription to canopen/line3/#"), std::string::npos)
      << broker_.dropped_why;
  EXPECT_TRUE(hears(now, false)) << "no command, until the connection is gone";
  session_.lost();
  connect(2, now);
  EXPECT_EQ(session_.phase(), Phase::subscribing) << "one look each";
}

TEST_F(SessionLook, WhatComesByItLaterEndsTheConnectionBeforeACommandComesTwice) {
  connect(1, start_);
  granted(start_);
  session_.tick(start_ + 500ms);
  session_.unsubscribed(start_ + 1s);
  ASSERT_EQ(session_.phase(), Phase::subscribing);
  session_.stray({.topic = "canopen/line3/info"});
  EXPECT_EQ(broker_.dropped, 1U);
  EXPECT_TRUE(hears(start_ + 1s, false));
  session_.lost();
  connect(2, start_ + 2s);
  session_.stray({.topic = "canopen/line3/info"});
  EXPECT_EQ(broker_.dropped, 1U) << "a connection without a look: nothing comes twice";
}

TEST_F(SessionLook, IsOnlyAtTheFirstConnectionToEachBroker) {
  connect(1, start_);
  granted(start_);
  session_.tick(start_ + 500ms);
  session_.lost();
  connect(2, start_ + 2s);
  EXPECT_EQ(session_.phase(), Phase::subscribing);
  session_.lost();
  connect(3, start_ + 3s, "other:1883");
  EXPECT_EQ(session_.phase(), Phase::looking);
  session_.lost();
  connect(4, start_ + 4s, "b:1883");
  EXPECT_EQ(session_.phase(), Phase::subscribing);
}

TEST_F(SessionLook, ThatIsRefusedIsSaidAndNotTriedAgain) {
  connect(1, start_);
  session_.subscribed({.filter = kTree, .refused = "Not authorized (0x87)"}, start_);
  EXPECT_EQ(session_.phase(), Phase::subscribing);
  EXPECT_EQ(broker_.unsubscribed, Filters{});
  EXPECT_TRUE(session_.refused().empty()) << "nothing is missing";
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_NE(notices_[0].find("canopen/line3/# is refused: Not authorized (0x87)"), std::string::npos) << notices_[0];
  session_.lost();
  connect(2, start_ + 1s);
  EXPECT_EQ(session_.phase(), Phase::subscribing);
}

TEST_F(SessionLook, ThatIsNotAnsweredIsSaidAndGivenBack) {
  connect(1, start_);
  session_.tick(start_ + Session::kSubscribePatience - 1ms);
  EXPECT_EQ(session_.phase(), Phase::looking);
  session_.tick(start_ + Session::kSubscribePatience);
  EXPECT_EQ(session_.phase(), Phase::leaving);
  EXPECT_EQ(broker_.unsubscribed, Filters{kTree});
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_NE(notices_[0].find("no answer within 10 s"), std::string::npos) << notices_[0];
}

TEST_F(SessionLook, ThatABreakEndedIsTriedAgainOnce) {
  connect(1, start_);
  session_.lost();
  connect(2, start_ + 1s);
  EXPECT_EQ(session_.phase(), Phase::looking);
  EXPECT_TRUE(notices_.empty());
  session_.lost();
  connect(3, start_ + 2s);
  EXPECT_EQ(session_.phase(), Phase::subscribing) << "a broker may refuse it by closing";
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_NE(notices_[0].find(kTree), std::string::npos) << notices_[0];
}

TEST_F(SessionLook, ThatWasGrantedIsLeftOutAfterThreeBreaks) {
  for (ConnectionId connection = 1; connection < 4; ++connection) {
    EXPECT_TRUE(notices_.empty());
    connect(connection, start_ + connection * 1s);
    EXPECT_EQ(session_.phase(), Phase::looking) << "whatever broke it, the look is still to be done";
    granted(start_ + connection * 1s);
    session_.lost();
  }
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_NE(notices_[0].find("three times in a row"), std::string::npos) << notices_[0];
  EXPECT_NE(notices_[0].find(kTree), std::string::npos) << notices_[0];
  connect(4, start_ + 4s);
  EXPECT_EQ(session_.phase(), Phase::subscribing) << "what is kept there may end each connection";
  session_.lost();
  EXPECT_EQ(notices_.size(), 1U);
}

TEST_F(SessionLook, BreaksAtOneBrokerDoNotCountAtAnother) {
  for (ConnectionId connection = 1; connection < 5; ++connection) {
    connect(connection, start_ + connection * 1s, connection % 2 == 0 ? "b:1883" : "other:1883");
    EXPECT_EQ(session_.phase(), Phase::looking);
    granted(start_ + connection * 1s);
    session_.lost();
  }
  EXPECT_TRUE(notices_.empty());
}

}  // namespace
}  // namespace mqtt
