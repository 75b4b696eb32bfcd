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
  Session session_{broker_, topics_};
  void answer_all() {
    for (std::size_t i = 0; i < broker_.subscribed.size(); ++i) {
      session_.subscribed();
    }
  }

  const canopen::TimePoint start_{1h};
};

TEST_F(SessionTest, SubscribesToCommandsAndToWhatOthersWriteOnAlarms) {
  session_.connected(1, start_);
  EXPECT_EQ(session_.phase(), Phase::subscribing);
  EXPECT_EQ(broker_.subscribed_on, 1U);
  for (const char* filter : {"+/set", "+/+/set", "+/sdo/request", "+/control/alive", "stop"}) {
    EXPECT_EQ(broker_.subscription("canopen/line3/" + std::string(filter)).watched, false) << filter;
  }
  for (const char* filter : {"+/alarm/emcy", "+/alarm/heartbeat", "+/alarm/boot", "+/alarm/data", "+/alarm/control",
                             "bus/+/alarm", "alarms"}) {
    EXPECT_EQ(broker_.subscription("canopen/line3/" + std::string(filter)).watched, true) << filter;
  }
  answer_all();
  EXPECT_TRUE(session_.ready());
  EXPECT_EQ(session_.deadline(), canopen::TimePoint::max());
}

TEST_F(SessionTest, AnAnswerThatNeverComesHoldsNothingUp) {
  session_.connected(1, start_);
  session_.tick(start_ + Session::kSubscribePatience - 1ms);
  EXPECT_FALSE(session_.ready());
  session_.tick(start_ + Session::kSubscribePatience);
  EXPECT_TRUE(session_.ready());
}

TEST_F(SessionTest, EachConnectionSubscribesAgain) {
  session_.connected(1, start_);
  answer_all();
  session_.lost();
  EXPECT_FALSE(session_.ready());
  answer_all();
  EXPECT_FALSE(session_.ready()) << "an answer of the old connection";
  session_.connected(2, start_);
  EXPECT_EQ(broker_.subscribed_on, 2U);
  answer_all();
  EXPECT_TRUE(session_.ready());
  EXPECT_EQ(session_.connection(), 2U);
}

}  // namespace
}  // namespace mqtt
