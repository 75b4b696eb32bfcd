#include "bridges/mqtt/session.h"

#include <gtest/gtest.h>

#include "tests/unit/mqtt/fake_broker.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using Phase = Session::Phase;

class SessionTest : public testing::Test {
 protected:
  config::Model model_ = test::model();
  Topics topics_{model_, "canopen", "line3"};
  test::FakeBroker broker_;
  Session session_{broker_, topics_, 1};
  const canopen::TimePoint start_{1h};
};

TEST_F(SessionTest, SubscribesToCommandsAndReadsAlarmsBackFirst) {
  session_.connected(1, start_);
  EXPECT_EQ(broker_.subscribed_on, 1U);
  EXPECT_TRUE(broker_.has_subscribed("canopen/line3/+/set"));
  EXPECT_TRUE(broker_.has_subscribed("canopen/line3/+/+/set"));
  EXPECT_TRUE(broker_.has_subscribed("canopen/line3/+/sdo/request"));
  EXPECT_TRUE(broker_.has_subscribed("canopen/line3/pump1/alarm/emcy"));
  session_.subscribed(start_);
  EXPECT_EQ(session_.phase(), Phase::reading_back);
  EXPECT_TRUE(session_.reads_back());
  session_.alarm_came(0);
  EXPECT_TRUE(session_.ready());
  EXPECT_FALSE(session_.reads_back());
  EXPECT_EQ(broker_.unsubscribed, std::vector<std::string>{"canopen/line3/pump1/alarm/emcy"});
}

TEST_F(SessionTest, AnAlarmMayComeBeforeTheAnswer) {
  session_.connected(1, start_);
  session_.alarm_came(0);
  EXPECT_FALSE(session_.ready());
  session_.subscribed(start_);
  EXPECT_TRUE(session_.ready());
}

TEST_F(SessionTest, WaitsAShortTimeForAlarmsThatAreNotThere) {
  session_.connected(1, start_);
  session_.subscribed(start_ + 100ms);
  EXPECT_EQ(session_.deadline(), start_ + 100ms + Session::kReadBack);
  session_.tick(start_ + 1099ms);
  EXPECT_FALSE(session_.ready());
  session_.tick(start_ + 1100ms);
  EXPECT_TRUE(session_.ready());
}

TEST_F(SessionTest, AnAnswerThatNeverComesHoldsNothingUp) {
  session_.connected(1, start_);
  session_.tick(start_ + Session::kSubscribePatience);
  EXPECT_TRUE(session_.ready());
}

TEST_F(SessionTest, ReadsBackOnlyOnce) {
  session_.connected(1, start_);
  session_.subscribed(start_);
  session_.alarm_came(0);
  session_.lost();
  EXPECT_FALSE(session_.ready());
  session_.connected(2, start_);
  EXPECT_FALSE(broker_.has_subscribed("canopen/line3/pump1/alarm/emcy"));
  session_.subscribed(start_);
  EXPECT_TRUE(session_.ready());
  EXPECT_EQ(session_.connection(), 2U);
}

TEST_F(SessionTest, AConnectionLostMeanwhileReadsBackAgain) {
  session_.connected(1, start_);
  session_.subscribed(start_);
  session_.lost();
  EXPECT_EQ(session_.deadline(), canopen::TimePoint::max());
  session_.connected(2, start_);
  EXPECT_TRUE(broker_.has_subscribed("canopen/line3/pump1/alarm/emcy"));
}

}  // namespace
}  // namespace mqtt
