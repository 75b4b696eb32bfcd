#include "daemon/demo_screen.h"

#include <gmock/gmock.h>

#include "tests/unit/daemon/demo_model.h"

namespace gateway {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(DemoGuide, CountsTheDrives) {
  config::Model model = test::demo_model();
  EXPECT_THAT(demo_guide(model), HasSubstr("4 simulated drives and the gateway"));
  model.drives.resize(1);
  EXPECT_THAT(demo_guide(model), HasSubstr("1 simulated drive and the gateway"));
}

// A command with an id would be refused as a repetition when it is given a second time.
TEST(DemoGuide, GivesCommandsThatMayBeRepeated) {
  EXPECT_THAT(demo_guide(test::demo_model()), Not(HasSubstr("\"id\"")));
}

TEST(DemoGuide, SpeaksTheControlWordsOfEachDrive) {
  const std::string guide = demo_guide(test::demo_model());
  EXPECT_THAT(guide,
              HasSubstr("canopen/demo/hoist1/set -m '{\"frequency_command\":40.0,\"control_command\":1}'   # run"));
  EXPECT_THAT(guide, HasSubstr("canopen/demo/hoist1/control_command/set -m 7   # fault reset"));
  EXPECT_THAT(guide,
              HasSubstr("canopen/demo/mixer1/set -m '{\"target_velocity\":900.0,\"control_command\":127}'   # run"));
  EXPECT_THAT(guide, HasSubstr("canopen/demo/mixer1/control_command/set -m 128   # fault reset"));
  EXPECT_THAT(guide, HasSubstr("-a 7 -0 -t 4 -r 101 -1 127.0.0.1 2500   # frequency_command"));
}

TEST(DemoGuide, TripsByRawWriteOnlyWhereTheSiteAllowsIt) {
  const std::string guide = demo_guide(test::demo_model());
  EXPECT_THAT(guide, HasSubstr("canopen/demo/pump1/sdo/request"));
  EXPECT_THAT(guide, Not(HasSubstr("canopen/demo/fan1/sdo/request")));
}

TEST(DemoGuide, LeavesOutWhatIsOff) {
  config::Model model = test::demo_model();
  model.mqtt.reset();
  EXPECT_THAT(demo_guide(model), Not(HasSubstr("mosquitto")));
  model.modbus.reset();
  EXPECT_THAT(demo_guide(model), Not(HasSubstr("mbpoll")));
}

}  // namespace
}  // namespace gateway
