#include "bridges/mqtt/topics.h"

#include <gtest/gtest.h>

#include <string>

#include "bridges/mqtt/info.h"
#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

class TopicsTest : public testing::Test {
 protected:
  config::Model model_ = test::model();
  Topics topics_{model_, *model_.mqtt, "line3"};
};

TEST_F(TopicsTest, AreThoseOfTheContract) {
  EXPECT_EQ(topics_.status(), "canopen/line3/status");
  EXPECT_EQ(topics_.info(), "canopen/line3/info");
  EXPECT_EQ(topics_.health(), "canopen/line3/health");
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
    EXPECT_EQ(topics_.route(topic)->kind, Route::Kind::alarm) << topic;
  }
  for (const char* topic : {"canopen/line3/status", "canopen/line3/pump1/status"}) {
    ASSERT_TRUE(topics_.route(topic)) << topic;
    EXPECT_EQ(topics_.route(topic)->kind, Route::Kind::status) << topic;
  }
  EXPECT_EQ(topics_.route("canopen/line3/pump1/status")->drive, "pump1");
  EXPECT_EQ(topics_.route("canopen/line3/status")->drive, "");
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

TEST_F(TopicsTest, RefusesResponseTopicsInTheTreeOfAnyGateway) {
  for (const char* topic :
       {"canopen/line3/status", "canopen/line3/info", "canopen/line3/pump1/state", "canopen/line3/pump1/alarm/emcy",
        "canopen/line3/bus/can0/alarm", "canopen/line3/alarms", "canopen/line4/pump1/status", "canopen/line4/health",
        "canopen/line3/client/7", "canopen", "canopen/line3/result", "canopen/line3/pump1/sdo/response"}) {
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
  for (const char* topic : {"answers/17", "other/set", "canopens/line3", "a/canopen/line3/set"}) {
    EXPECT_FALSE(topics_.refused_as_response(topic)) << topic;
  }
}

TEST_F(TopicsTest, AllowsOnlyWhatAnswersNames) {
  config::Mqtt settings;
  settings.answers = {"app/#", "panel/+/reply"};
  const Topics topics(model_, settings, "line3");
  for (const char* topic : {"app", "app/1", "app/1/2", "panel/7/reply"}) {
    EXPECT_FALSE(topics.refused_as_response(topic)) << topic;
  }
  for (const char* topic : {"answers/1", "apps/1", "panel/7", "panel/7/8/reply", "panel/reply", "canopen/line3/app"}) {
    EXPECT_TRUE(topics.refused_as_response(topic)) << topic;
  }
  settings.answers = {"#"};
  EXPECT_TRUE(Topics(model_, settings, "line3").refused_as_response("canopen/line4/x")) << "base stays out";
  settings.answers.emplace();
  EXPECT_TRUE(Topics(model_, settings, "line3").refused_as_response("app/1")) << "nowhere";
}

// MQTT 5 §4.7.1, with the examples given there.
TEST(Filters, StandForTopics) {
  struct Case {
    const char* filter;
    const char* topic;
    bool matches;
  };
  for (const Case& each :
       {Case{"sport/tennis/player1/#", "sport/tennis/player1", true},
        Case{"sport/tennis/player1/#", "sport/tennis/player1/score/wimbledon", true}, Case{"sport/#", "sport", true},
        Case{"#", "a/b/c", true}, Case{"sport/tennis/+", "sport/tennis/player1", true},
        Case{"sport/tennis/+", "sport/tennis/player1/ranking", false}, Case{"sport/+", "sport", false},
        Case{"sport/+", "sport/", true}, Case{"+/+", "/finance", true}, Case{"/+", "/finance", true},
        Case{"+", "/finance", false}, Case{"#", "$SYS/uptime", false},
        Case{"+/monitor/Clients", "$SYS/monitor/Clients", false}, Case{"a/b", "a/b", true}, Case{"a/b", "a/b/c", false},
        Case{"a/b/c", "a/b", false}}) {
    EXPECT_EQ(matches(each.filter, each.topic), each.matches) << each.filter << " and " << each.topic;
  }
}

TEST_F(TopicsTest, InfoNamesThoseOfSignalsOnlyWhereTheyArePublished) {
  for (const bool published : {true, false}) {
    model_.mqtt->signals = published;
    const std::string info = info_json(model_, topics_, "1.2.3", "A1");
    const auto has = [&info](const char* text) { return info.find(text) != std::string::npos; };
    EXPECT_EQ(has(R"("topic":"canopen/line3/pump1/status_word","set":null)"), published) << info;
    EXPECT_EQ(has(R"("topic":null,"set":null)"), !published) << info;
    EXPECT_TRUE(has(R"("set":"canopen/line3/pump1/energy/set")")) << info;
  }
}

}  // namespace
}  // namespace mqtt
