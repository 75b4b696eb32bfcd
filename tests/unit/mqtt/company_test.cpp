// Numbers wait behind a batch, so that those of several frames go to the broker together.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "bridges/mqtt/bridge.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

constexpr const char* kFrequency = "canopen/line3/pump1/output_frequency";

class MqttCompany : public testing::Test {
 protected:
  static config::Model every_change(const std::string& drive = "pump1") {
    config::Model model = PlantSite::bridge_model();
    model.mqtt->min_interval = 0ms;
    model.drives[0].name = drive;
    return model;
  }
  void SetUp() override {
    site_.bring_up_drive();
    site_.connect();
    site_.run(1s);
    site_.loop().advance(4ms);
    site_.broker().forget();
  }
  /// One number was told, and another one waits.
  void let_one_wait() {
    site_.send_values(0, 100, 3);
    site_.loop().advance(1ms);
    site_.send_values(0, 200, 3);
    ASSERT_EQ(told(), std::vector<std::string>{"1.00"});
  }
  [[nodiscard]] std::vector<std::string> told() { return site_.broker().on(kFrequency); }

  PlantSite site_{every_change()};
};

TEST_F(MqttCompany, NumbersWaitForItBehindABatchAndEachIsTold) {
  let_one_wait();
  site_.loop().advance(2ms);
  site_.send_values(0, 300, 3);
  EXPECT_EQ(told().size(), 1U);
  EXPECT_EQ(site_.broker().batches, 1U);
  site_.loop().advance(1ms);  // 4 ms behind the first
  EXPECT_EQ(told(), (std::vector<std::string>{"1.00", "2.00", "3.00"})) << "not later for the third";
  EXPECT_EQ(site_.broker().batches, 2U);
  site_.loop().advance(10ms);
  site_.send_values(0, 400, 3);
  EXPECT_EQ(told().back(), "4.00") << "nothing was told just before";
}

TEST_F(MqttCompany, ABooleanGoesAtOnceWithWhatWaits) {
  let_one_wait();
  site_.send_values(0x0001, 300, 4);
  EXPECT_EQ(site_.broker().on("canopen/line3/pump1/running"), std::vector<std::string>{"true"});
  EXPECT_EQ(told(), (std::vector<std::string>{"1.00", "2.00", "3.00"}));
}

TEST_F(MqttCompany, AnAlarmGoesAtOnce) {
  let_one_wait();
  site_.puppet().dictionary[{0x1001, 0}].value = 1;
  site_.puppet().emergency(std::array<std::uint8_t, 8>{0x10, 0x23, 0x01, 0, 0, 0, 0, 0});
  site_.loop().settle();
  EXPECT_TRUE(contains(site_.retained("pump1/alarm/emcy"), "0x2310"));
}

TEST_F(MqttCompany, AnAnswerGoesAtOnce) {
  let_one_wait();
  site_.command("pump1/frequency_command/set", "99");
  EXPECT_TRUE(contains(site_.last_answer(), R"("code":"range")")) << site_.last_answer();
}

TEST_F(MqttCompany, TheLastWordsComeBehindWhatWaits) {
  let_one_wait();
  site_.stop_bridge();
  std::vector<std::string> last;
  for (const Message& message : site_.broker().last_words) {
    if (message.topic == kFrequency) {
      last.push_back(message.payload);
    }
  }
  EXPECT_EQ(last, (std::vector<std::string>{"2.00", ""}));
  site_.loop().advance(10ms);
  EXPECT_EQ(told().size(), 1U) << "nothing behind them";
}

TEST_F(MqttCompany, OfADriveThatGoesNothingStaysOfWhatWaited) {
  let_one_wait();
  site_.change(every_change("pump2"));
  site_.loop().advance(10ms);
  EXPECT_EQ(told().back(), "") << "the last word on that topic";
}

TEST_F(MqttCompany, WhatWaitedAtABreakIsNotOfTheNextConnection) {
  let_one_wait();
  site_.broker().events->on_disconnected("the connection broke");
  site_.loop().advance(10ms);
  EXPECT_EQ(told(), std::vector<std::string>{"1.00"});
}

}  // namespace
}  // namespace mqtt
