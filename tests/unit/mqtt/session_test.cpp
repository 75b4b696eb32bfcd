#include "bridges/mqtt/session.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/unit/mqtt/fake_broker.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using Phase = Session::Phase;

class SessionTest : public testing::Test {
 protected:
  /// A connection that may not look through the tree.
  void connect(ConnectionId connection, canopen::TimePoint at) {
    session_.connected({.id = connection, .broker = "b:1883"}, at);
    if (session_.phase() == Phase::looking) {
      broker_.unanswered.clear();
      session_.subscribed({.filter = kTree, .refused = "no"}, at);
      notices_.clear();
    }
  }
  /// All that is asked is granted but this one, and what is asked then.
  void answer(const std::string& refused = {}, const std::string& why = "Not authorized (0x87)") {
    while (!broker_.unanswered.empty()) {
      for (const Subscription& each : std::exchange(broker_.unanswered, {})) {
        Subscribed answer{.filter = each.filter};
        if (each.filter == refused) {
          answer.refused = why;
        }
        session_.subscribed(answer, now_);
      }
    }
  }
  /// Filters that are subscribed to when time has come so far.
  std::vector<std::string> asked_at(canopen::TimePoint at) {
    now_ = at;
    broker_.unanswered.clear();
    session_.tick(at);
    std::vector<std::string> filters;
    for (const Subscription& each : broker_.unanswered) {
      filters.push_back(each.filter);
    }
    return filters;
  }

  using Filters = std::vector<std::string>;
  static constexpr const char* kTree = "canopen/line3/#";
  static constexpr const char* kStop = "canopen/line3/stop";
  config::Model model_ = test::model();
  Topics topics_{model_, *model_.mqtt, "line3"};
  test::FakeBroker broker_;
  std::vector<std::string> notices_;
  Session session_{broker_, topics_, [this](Level, std::string text) { notices_.push_back(std::move(text)); }};
  const canopen::TimePoint start_{1h};
  canopen::TimePoint now_ = start_;
};

TEST_F(SessionTest, SubscribesToCommandsAndThenToWhatOthersWriteOnAlarmsAndStatuses) {
  connect(1, start_);
  EXPECT_EQ(session_.phase(), Phase::subscribing);
  EXPECT_EQ(broker_.subscribed_on, 1U);
  for (const Subscription& each : std::exchange(broker_.unanswered, {})) {
    EXPECT_FALSE(each.watched) << each.filter << ": a broker may close the connection for it";
    session_.subscribed({.filter = each.filter}, start_);
  }
  EXPECT_EQ(session_.phase(), Phase::watching);
  for (const char* filter : {"+/set", "+/+/set", "+/sdo/request", "+/control/alive", "stop"}) {
    EXPECT_EQ(broker_.subscription("canopen/line3/" + std::string(filter)).watched, false) << filter;
  }
  for (const char* filter : {"+/alarm/emcy", "+/alarm/heartbeat", "+/alarm/boot", "+/alarm/data", "+/alarm/control",
                             "bus/+/alarm", "alarms", "status", "+/status"}) {
    EXPECT_EQ(broker_.subscription("canopen/line3/" + std::string(filter)).watched, true) << filter;
  }
  answer();
  EXPECT_TRUE(session_.ready());
  EXPECT_EQ(session_.deadline(), canopen::TimePoint::max());
  EXPECT_TRUE(session_.refused().empty());
  EXPECT_TRUE(notices_.empty());
}

TEST_F(SessionTest, IsReadyWhenTheLastOneIsAnswered) {
  connect(1, start_);
  while (!broker_.unanswered.empty()) {
    for (const Subscription& each : std::exchange(broker_.unanswered, {})) {
      EXPECT_FALSE(session_.ready());
      session_.subscribed({.filter = each.filter}, start_);
    }
  }
  EXPECT_TRUE(session_.ready());
}

TEST_F(SessionTest, AnAnswerThatNeverComesHoldsNothingUpAndIsSaid) {
  connect(1, start_);
  std::erase_if(broker_.unanswered, [](const Subscription& each) { return each.filter == kStop; });
  answer();
  EXPECT_EQ(asked_at(start_ + Session::kSubscribePatience - 1ms), Filters{});
  EXPECT_FALSE(session_.ready());
  EXPECT_EQ(session_.deadline(), start_ + Session::kSubscribePatience);
  EXPECT_EQ(asked_at(start_ + Session::kSubscribePatience).size(), topics_.watched_subscriptions().size());
  answer();
  EXPECT_TRUE(session_.ready());
  EXPECT_EQ(session_.refused(), Filters{kStop});
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_NE(notices_[0].find("canopen/line3/stop is refused: no answer within 10 s"), std::string::npos) << notices_[0];
}

TEST_F(SessionTest, ARefusedOneIsTriedAgainAloneWithGrowingPauses) {
  connect(1, start_);
  answer(kStop);
  EXPECT_TRUE(session_.ready());
  EXPECT_EQ(session_.refused(), Filters{kStop});
  canopen::TimePoint at = start_;
  for (const canopen::Duration pause : {1s, 2s, 4s, 5s, 5s}) {
    EXPECT_EQ(asked_at(at + pause - 1ms), Filters{});
    at += pause;
    EXPECT_EQ(session_.deadline(), at);
    EXPECT_EQ(asked_at(at), Filters{kStop});
    EXPECT_EQ(session_.refused(), Filters{kStop}) << "not answered yet";
    answer(kStop);
  }
  ASSERT_EQ(notices_.size(), 1U) << "once";
  EXPECT_NE(notices_[0].find("canopen/line3/stop is refused: Not authorized (0x87). Commands"), std::string::npos)
      << notices_[0];
  EXPECT_EQ(asked_at(at + 5s), Filters{kStop});
  answer();
  EXPECT_TRUE(session_.refused().empty());
  EXPECT_EQ(session_.deadline(), canopen::TimePoint::max());
  ASSERT_EQ(notices_.size(), 2U);
  EXPECT_NE(notices_[1].find("grants the subscription to canopen/line3/stop"), std::string::npos) << notices_[1];
}

TEST_F(SessionTest, OnTheNextConnectionARefusalThatStandsIsNotSaidAgain) {
  connect(1, start_);
  answer(kStop);
  session_.lost();
  EXPECT_TRUE(session_.refused().empty()) << "nothing is known";
  connect(2, start_ + 20s);
  answer(kStop);
  EXPECT_EQ(notices_.size(), 1U);
  EXPECT_EQ(session_.deadline(), start_ + 1s) << "and the pauses begin anew; the test's clock stands";
}

TEST_F(SessionTest, OneThatIsNotAnsweredThreeTimesEndsTheConnection) {
  connect(1, start_);
  std::erase_if(broker_.unanswered, [](const Subscription& each) { return each.filter == kStop; });
  answer();
  canopen::TimePoint at = start_;
  for (const canopen::Duration pause : {1s, 2s}) {
    asked_at(at += Session::kSubscribePatience);
    answer();  // of the watched ones
    EXPECT_EQ(asked_at(at += pause), Filters{kStop});
    EXPECT_EQ(broker_.dropped, 0U);
  }
  asked_at(at + Session::kSubscribePatience);
  EXPECT_EQ(broker_.dropped, 1U);
  EXPECT_NE(broker_.dropped_why.find("does not answer the subscription to canopen/line3/stop"), std::string::npos)
      << broker_.dropped_why;
  EXPECT_EQ(session_.phase(), Phase::offline);
  EXPECT_EQ(session_.deadline(), canopen::kNever);
}

TEST_F(SessionTest, AnAnswerEndsTheCount) {
  connect(1, start_);
  answer(kStop);
  canopen::TimePoint at = start_;
  for (int i = 0; i < 4; ++i) {
    at += 5s;
    EXPECT_EQ(asked_at(at), Filters{kStop});
    at += Session::kSubscribePatience;
    EXPECT_EQ(asked_at(at), Filters{});  // not answered
    at += 5s;
    EXPECT_EQ(asked_at(at), Filters{kStop});
    answer(kStop);
  }
  EXPECT_EQ(broker_.dropped, 0U);
}

// Some brokers refuse by closing.
TEST_F(SessionTest, AWatchedOneAtWhichTheConnectionBreaksTwiceIsLeftOutAtThisBroker) {
  constexpr const char* kAlarms = "canopen/line3/alarms";
  const auto break_at = [this](const std::string& filter, ConnectionId connection) {
    connect(connection, now_);
    bool broken = false;
    while (!broken && !broker_.unanswered.empty()) {
      for (const Subscription& each : std::exchange(broker_.unanswered, {})) {
        broken = broken || each.filter == filter;
        if (!broken) {
          session_.subscribed({.filter = each.filter}, now_);
        }
      }
    }
    session_.lost();
    return broken;
  };
  EXPECT_TRUE(break_at(kAlarms, 1));
  connect(2, now_);
  answer();
  EXPECT_TRUE(session_.ready()) << "once may be chance";
  session_.lost();
  EXPECT_TRUE(break_at(kAlarms, 3)) << "not in a row with the first";
  EXPECT_TRUE(notices_.empty());
  EXPECT_TRUE(break_at(kAlarms, 4));
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_NE(notices_[0].find(kAlarms), std::string::npos) << notices_[0];
  EXPECT_FALSE(break_at(kAlarms, 5)) << "it is not asked for";
  connect(6, now_);
  answer();
  EXPECT_TRUE(session_.ready());
  EXPECT_EQ(session_.refused(), Filters{kAlarms});
  EXPECT_EQ(notices_.size(), 1U);
  session_.lost();
  EXPECT_TRUE(session_.refused().empty());
  session_.connected({.id = 7, .broker = "other:1883"}, now_);
  session_.subscribed({.filter = kTree, .refused = "no"}, now_);
  answer();
  EXPECT_TRUE(session_.refused().empty()) << "another broker may allow it";
}

TEST_F(SessionTest, CommandsAreNeverLeftOut) {
  for (ConnectionId connection = 1; connection < 6; ++connection) {
    connect(connection, now_);
    EXPECT_EQ(broker_.unanswered.size(), topics_.command_subscriptions().size());
    session_.lost();
  }
  EXPECT_TRUE(notices_.empty());
}

TEST_F(SessionTest, EachConnectionSubscribesAgain) {
  connect(1, start_);
  answer();
  session_.lost();
  EXPECT_FALSE(session_.ready());
  EXPECT_EQ(session_.deadline(), canopen::TimePoint::max());
  answer();
  EXPECT_FALSE(session_.ready()) << "an answer of the old connection";
  connect(2, start_);
  EXPECT_EQ(broker_.subscribed_on, 2U);
  answer();
  EXPECT_TRUE(session_.ready());
  EXPECT_EQ(session_.connection(), 2U);
}

}  // namespace
}  // namespace mqtt
