// What Home Assistant is told when the plant's configuration changes while it runs.

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "bridges/mqtt/home_assistant/discovery.h"
#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using home_assistant::Discovery;
using test::contains;
using test::PlantSite;

constexpr const char* kPump = "homeassistant/device/canopen_line3/pump1/config";
constexpr const char* kFan = "homeassistant/device/canopen_line3/fan1/config";

config::Model pump_in_home_assistant() {
  config::Model model = PlantSite::bridge_model();
  model.mqtt->home_assistant = "homeassistant";
  return model;
}

config::Model with_fan() {
  config::Model model = pump_in_home_assistant();
  config::Drive fan = model.drives[0];
  fan.name = "fan1";
  fan.node.node = 6;
  fan.node.tpdos[0].cob_id = 0x186;
  fan.node.rpdos[0].cob_id = 0x206;
  model.drives.push_back(fan);
  return model;
}

void begin(PlantSite& site) {
  site.bring_up_drive();
  site.connect();
  site.run(Discovery::kLeast + 1s);
  site.broker().forget();
}

TEST(HomeAssistantReload, ADriveThatComesIsToldOfAndNoOther) {
  PlantSite site(pump_in_home_assistant());
  begin(site);
  site.change(with_fan());
  site.run(Discovery::kPause + 100ms);
  ASSERT_EQ(site.broker().on(kFan).size(), 1U);
  EXPECT_TRUE(contains(site.broker().on(kFan)[0], R"("name":"line3 fan1")")) << site.broker().on(kFan)[0];
  site.run(Discovery::kLeast);
  EXPECT_TRUE(site.broker().on(kPump).empty());
}

TEST(HomeAssistantReload, ADriveThatGoesIsRemoved) {
  PlantSite site(with_fan());
  begin(site);
  site.change(pump_in_home_assistant());
  site.run(Discovery::kLeast);
  EXPECT_EQ(site.broker().on(kFan), std::vector<std::string>{""});
  EXPECT_TRUE(site.broker().on(kPump).empty());
  site.change(with_fan());
  site.run(Discovery::kLeast);
  EXPECT_TRUE(contains(site.broker().newest(kFan).payload, R"("name":"line3 fan1")"));
}

TEST(HomeAssistantReload, ASignalThatGoesIsRemovedFromItsDevice) {
  PlantSite site(pump_in_home_assistant());
  begin(site);
  config::Model changed = pump_in_home_assistant();
  changed.drives[0].signals.pop_back();
  site.change(changed);
  site.run(Discovery::kPause + 100ms);
  ASSERT_EQ(site.broker().on(kPump).size(), 1U);
  const std::string message = site.broker().on(kPump)[0];
  EXPECT_TRUE(contains(message, R"("binary_sensor_brake":{"platform":"binary_sensor"})")) << message;
  EXPECT_TRUE(contains(message, R"("sensor_output_frequency":{"platform":"sensor","unique_id")")) << message;
}

TEST(HomeAssistantReload, StartsOfHomeAssistantAreHeardForTheDrivesThatAreThere) {
  PlantSite site(with_fan());
  begin(site);
  site.change(pump_in_home_assistant());
  site.run(Discovery::kLeast);
  site.broker().forget();
  site.receive({.topic = "homeassistant/status", .payload = "online"});
  site.run(Discovery::kLeast);
  EXPECT_EQ(site.broker().on(kPump).size(), 1U);
  EXPECT_TRUE(site.broker().on(kFan).empty());
}

}  // namespace
}  // namespace mqtt
