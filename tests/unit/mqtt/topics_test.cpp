#include "bridges/mqtt/topics.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

class TopicsTest : public testing::Test {
 protected:
  config::Model model_ = test::model();
  Topics topics_{model_, "canopen", "line3"};
};

TEST_F(TopicsTest, AreThoseOfTheContract) {
  EXPECT_EQ(topics_.status(), "canopen/line3/status");
  EXPECT_EQ(topics_.info(), "canopen/line3/info");
  EXPECT_EQ(topics_.result(), "canopen/line3/result");
  EXPECT_EQ(topics_.alarms(), "canopen/line3/alarms");
  EXPECT_EQ(topics_.bus_alarm(0), "canopen/line3/bus/can0/alarm");
  const DriveTopics& pump = topics_.drive(0);
  EXPECT_EQ(pump.status, "canopen/line3/pump1/status");
  EXPECT_EQ(pump.state, "canopen/line3/pump1/state");
  EXPECT_EQ(pump.control, "canopen/line3/pump1/control");
  EXPECT_EQ(pump.sdo_response, "canopen/line3/pump1/sdo/response");
  EXPECT_EQ(pump.alarms[0], "canopen/line3/pump1/alarm/emcy");
  EXPECT_EQ(pump.alarms[4], "canopen/line3/pump1/alarm/control");
  EXPECT_EQ(pump.signals.at(test::kFrequency), "canopen/line3/pump1/output_frequency");
  EXPECT_EQ(status_topic("a/b", "g"), "a/b/g/status");
}

TEST_F(TopicsTest, RoutesCommands) {
  const auto signal = topics_.route("canopen/line3/pump1/frequency_command/set");
  ASSERT_TRUE(signal);
  EXPECT_EQ(signal->kind, Route::Kind::set_signal);
  EXPECT_EQ(signal->drive, "pump1");
  EXPECT_EQ(signal->signal, "frequency_command");
  EXPECT_EQ(topics_.route("canopen/line3/pump1/set")->kind, Route::Kind::set_drive);
  EXPECT_EQ(topics_.route("canopen/line3/pump1/nmt/set")->kind, Route::Kind::nmt);
  EXPECT_EQ(topics_.route("canopen/line3/pump1/sdo/request")->kind, Route::Kind::sdo);
  EXPECT_EQ(topics_.route("canopen/line3/pump1/control/alive")->kind, Route::Kind::alive);
  EXPECT_EQ(topics_.route("canopen/line3/pump1/control/alive")->drive, "pump1");
  EXPECT_EQ(topics_.route("canopen/line3/stop")->kind, Route::Kind::stop_all);
  for (const char* topic : {"canopen/line3/pump1/alarm/emcy", "canopen/line3/bus/can0/alarm", "canopen/line3/alarms"}) {
    ASSERT_TRUE(topics_.route(topic)) << topic;
    EXPECT_EQ(topics_.route(topic)->kind, Route::Kind::watched) << topic;
  }
  EXPECT_EQ(topics_.route("canopen/line3/nobody/set")->drive, "nobody");
}

TEST_F(TopicsTest, RoutesNothingElse) {
  for (const char* topic :
       {"", "canopen/line3", "canopen/line3/", "canopen/line3/set", "canopen/line33/pump1/set",
        "canopen/line3/pump1/state", "canopen/line3/pump1/a/b/set", "other/line3/pump1/set",
        "canopen/line3/pump1/sdo/response", "canopen/line3/pump1/request", "canopen/line3/pump1/stop",
        "canopen/line4/stop", "canopen/line3/pump1/control", "canopen/line3/control/alive", "canopen/line4/alarms",
        "canopen/line3/pump1/alarms", "canopen/line3/pump1/can0/alarm"}) {
    EXPECT_FALSE(topics_.route(topic)) << topic;
  }
}

TEST_F(TopicsTest, RefusesResponseTopicsThatAreCommandsOfAnyGateway) {
  for (const char* topic : {"canopen/line3/pump1/set", "canopen/line3/pump1/frequency_command/set",
                            "canopen/line4/fan/set", "canopen/line3/pump1/nmt/set", "canopen/line3/pump1/sdo/request",
                            "canopen/line3/pump1/control/alive", "canopen/line3/stop", "canopen/line4/stop"}) {
    EXPECT_TRUE(topics_.refused_as_response(topic)) << topic;
  }
}

TEST_F(TopicsTest, RefusesResponseTopicsThatWePublishOurselves) {
  for (const char* topic : {"canopen/line3/status", "canopen/line3/info", "canopen/line3/pump1/state",
                            "canopen/line3/pump1/alarm/emcy", "canopen/line3/bus/can0/alarm", "canopen/line3/alarms"}) {
    EXPECT_TRUE(topics_.refused_as_response(topic)) << topic;
  }
}

TEST_F(TopicsTest, RefusesWhatIsNoTopicToPublishTo) {
  EXPECT_TRUE(topics_.refused_as_response(""));
  EXPECT_TRUE(topics_.refused_as_response("a/#"));
  EXPECT_TRUE(topics_.refused_as_response("a/+/b"));
  EXPECT_TRUE(topics_.refused_as_response("$SYS/x"));
  EXPECT_TRUE(topics_.refused_as_response(std::string("a\0b", 3)));
  EXPECT_TRUE(topics_.refused_as_response("a\xFF"));
  EXPECT_TRUE(topics_.refused_as_response(std::string(2000, 'a')));
}

TEST_F(TopicsTest, AllowsEverythingElseAsResponseTopic) {
  for (const char* topic : {"answers/17", "canopen/line3/result", "canopen/line3/pump1/sdo/response", "other/set",
                            "canopen/line3/client/7"}) {
    EXPECT_FALSE(topics_.refused_as_response(topic)) << topic;
  }
}

}  // namespace
}  // namespace mqtt
