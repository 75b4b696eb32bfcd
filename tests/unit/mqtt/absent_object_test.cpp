// What MQTT shows of an object that the drive does not have.

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "tests/unit/mqtt/plant_site.h"

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using test::contains;
using test::PlantSite;

TEST(AbsentObject, IsNullAndNobodyWaitsForIt) {
  PlantSite site;
  site.puppet().dictionary.erase({0x2031, 0});
  site.bring_up_drive();
  site.connect();
  EXPECT_TRUE(contains(site.retained("pump1/state"), R"("fresh":true)")) << site.retained("pump1/state");
  EXPECT_TRUE(contains(site.retained("pump1/state"), R"("mode":null)")) << site.retained("pump1/state");
  EXPECT_EQ(site.retained("pump1/mode"), "");
  const std::string alarm = site.retained("pump1/alarm/data");
  EXPECT_TRUE(contains(alarm, R"("active":true)")) << alarm;
  EXPECT_TRUE(contains(alarm, "the drive has no object 0x2031:00 (mode)")) << alarm;
}

TEST(AbsentObject, ThatVanishesTakesItsValueAlong) {
  PlantSite site;
  site.bring_up_drive();
  site.connect();
  ASSERT_EQ(site.retained("pump1/mode"), "speed");
  site.puppet().dictionary.erase({0x2031, 0});
  site.run(2s);
  EXPECT_EQ(site.retained("pump1/mode"), "");
  EXPECT_TRUE(contains(site.retained("pump1/state"), R"("fresh":true)")) << site.retained("pump1/state");
  EXPECT_TRUE(contains(site.retained("pump1/state"), R"("mode":null)")) << site.retained("pump1/state");
}

}  // namespace
}  // namespace mqtt
