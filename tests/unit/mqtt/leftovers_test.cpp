#include "bridges/mqtt/leftovers.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using Names = std::vector<std::string>;

class LeftoversTest : public testing::Test {
 protected:
  static Incoming kept(std::string topic, std::string payload = "x") {
    return {.topic = std::move(topic), .payload = std::move(payload), .retained = true};
  }
  /// What is emptied by now.
  Names emptied(Leftovers& leftovers, canopen::TimePoint now, bool another_lives = false) {
    std::vector<Message> out;
    leftovers.collect(another_lives, now, out, [this](Level, const std::string& text) { notices_.push_back(text); });
    Names topics;
    for (const Message& message : out) {
      EXPECT_EQ(message, Message{.topic = message.topic}) << "retained, empty, for ever";
      topics.push_back(message.topic);
    }
    return topics;
  }
  Names found_in(const Names& topics) {
    Leftovers leftovers(model_, settings_, topics_);
    for (const std::string& topic : topics) {
      leftovers.heard(kept(topic));
    }
    leftovers.announced(start_);
    return emptied(leftovers, start_);
  }

  config::Model model_ = test::model();
  config::Mqtt settings_;
  Topics topics_{model_, settings_, "line3"};
  std::vector<std::string> notices_;
  const canopen::TimePoint start_{1h};
};

TEST_F(LeftoversTest, WhatIsPublishedStays) {
  Names all{topics_.status(), topics_.info(), topics_.health(), topics_.alarms(), topics_.bus_alarm(0)};
  const DriveTopics& pump = topics_.drive(0);
  all.insert(all.end(), {pump.status, pump.state, pump.control, pump.signals.at(test::kFrequency)});
  all.insert(all.end(), pump.alarms.begin(), pump.alarms.end());
  EXPECT_EQ(found_in(all), Names{});
  EXPECT_TRUE(notices_.empty());
}

TEST_F(LeftoversTest, ADriveThatIsGoneIsEmptied) {
  const Names all{"canopen/line3/old/alarm/emcy", "canopen/line3/old/control", "canopen/line3/old/speed",
                  "canopen/line3/old/state", "canopen/line3/old/status"};
  EXPECT_EQ(found_in({all[3], all[4], all[0], all[2], all[1]}), all);
  ASSERT_EQ(notices_.size(), 1U);
  for (const std::string& topic : all) {
    EXPECT_NE(notices_[0].find(" " + topic), std::string::npos) << notices_[0];
  }
}

TEST_F(LeftoversTest, ADriveWhoseOnlineHasExpiredIsKnownByItsAlarms) {
  const Names all{"canopen/line3/old/alarm/boot", "canopen/line3/old/control"};
  EXPECT_EQ(found_in(all), all);
}

TEST_F(LeftoversTest, ASignalOrABusThatIsGoneIsEmptied) {
  const Names all{"canopen/line3/bus/can7/alarm", "canopen/line3/pump1/old_signal"};
  EXPECT_EQ(found_in(all), all);
}

TEST_F(LeftoversTest, WhatWasSwitchedOffIsEmptied) {
  settings_.signals = false;
  settings_.state = false;
  const DriveTopics& pump = topics_.drive(0);
  EXPECT_EQ(found_in({pump.state, pump.signals.at(test::kFrequency), pump.status}),
            (Names{pump.signals.at(test::kFrequency), pump.state}));
}

TEST_F(LeftoversTest, WhatOthersPutThereIsLeftAlone) {
  EXPECT_EQ(found_in({
                "canopen/line3/app/setting",          // neither status nor alarms: it never was a drive
                "canopen/line3/pump1/alarm/other",    // no kind of alarm
                "canopen/line3/pump1/sdo/request",    // commands are refused where they are read
                "canopen/line3/pump1/set",            //
                "canopen/line3/pump1/frequency/set",  //
                "canopen/line3/pump1/nmt/set",        //
                "canopen/line3/pump1/control/alive",  //
                "canopen/line3/stop",                 //
                "canopen/line3/pump1/Notes",          // no name of a signal
                "canopen/line3/pump1/",               //
                "canopen/line3//status",              //
                "canopen/line3/notes",                //
                "canopen/line3/bus/status",           // no alarm of a bus
                "canopen/line3/bus//alarm",           //
                "canopen/line3/bus/can0/alarm/emcy",  //
                "canopen/line4/old/status",           // another gateway's
                "canopen/line33/old/status",          //
                "canopen/line3",                      //
                "other/line3/old/status",             //
            }),
            Names{});
}

TEST_F(LeftoversTest, OnlyWhatTheBrokerKeptCounts) {
  Leftovers leftovers(model_, settings_, topics_);
  leftovers.heard({.topic = "canopen/line3/pump1/old_signal", .payload = "1", .retained = false});
  leftovers.heard(kept("canopen/line3/pump1/other_signal", ""));
  leftovers.announced(start_);
  EXPECT_EQ(leftovers.next(), canopen::kNever);
  EXPECT_EQ(emptied(leftovers, start_ + 1h), Names{});
}

TEST_F(LeftoversTest, WhereSomebodyMayLiveItIsWaitedForWhetherHeIsHeard) {
  const Names old{"canopen/line3/pump1/old_signal"};
  settings_.expiry = 90s;
  Leftovers leftovers(model_, settings_, topics_);
  leftovers.heard(kept(old[0]));
  leftovers.heard(kept(topics_.status(), "online"));
  leftovers.announced(start_);
  EXPECT_EQ(leftovers.next(), start_ + 35s);
  EXPECT_EQ(emptied(leftovers, start_ + 34s), Names{});
  leftovers.announced(start_ + 60s);  // nothing was heard while there was no connection
  EXPECT_EQ(emptied(leftovers, start_ + 94s), Names{});
  EXPECT_EQ(emptied(leftovers, start_ + 95s), old);
  EXPECT_EQ(leftovers.next(), canopen::kNever);
  leftovers.announced(start_ + 100s);
  EXPECT_EQ(emptied(leftovers, start_ + 1h), Names{}) << "once";
}

TEST_F(LeftoversTest, WhereAnotherGatewayLivesNothingIsEmptiedEver) {
  Leftovers leftovers(model_, settings_, topics_);
  leftovers.heard(kept("canopen/line3/old/status"));
  leftovers.announced(start_);
  EXPECT_EQ(emptied(leftovers, start_, true), Names{});
  ASSERT_EQ(notices_.size(), 1U);
  EXPECT_NE(notices_[0].find("1 topics"), std::string::npos) << notices_[0];
  leftovers.announced(start_ + 1h);
  EXPECT_EQ(emptied(leftovers, start_ + 2h), Names{});
  EXPECT_EQ(notices_.size(), 1U);
}

TEST_F(LeftoversTest, IsBoundedAndNamesEachInLinesOfBoundedLength) {
  Leftovers leftovers(model_, settings_, topics_);
  for (std::size_t i = 0; i < Leftovers::kMost + 10; ++i) {
    leftovers.heard(kept("canopen/line3/pump1/gone_" + std::to_string(i)));
  }
  leftovers.announced(start_);
  const Names all = emptied(leftovers, start_);
  EXPECT_EQ(all.size(), Leftovers::kMost);
  std::string said;
  for (const std::string& notice : notices_) {
    EXPECT_LT(notice.size(), 1200U);
    said += notice + " ";
  }
  for (const std::string& topic : all) {
    EXPECT_NE(said.find(" " + topic + " "), std::string::npos) << topic;
  }
}

}  // namespace
}  // namespace mqtt
