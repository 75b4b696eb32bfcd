#include "daemon/demo_screen.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "tests/unit/daemon/demo_model.h"

namespace gateway {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string guide_of(const config::Model& model) {
  return demo_guide(model, test::demo_loaded().notes);
}

TEST(DemoGuide, BeginsWithTheAddressOfThePage) {
  EXPECT_TRUE(guide_of(test::demo_model()).starts_with("The page: http://127.0.0.1:9465/\n"));
}

TEST(DemoGuide, CountsTheDrives) {
  config::Model model = test::demo_model();
  EXPECT_THAT(guide_of(model), HasSubstr("4 simulated drives and the gateway"));
  model.drives.resize(1);
  EXPECT_THAT(guide_of(model), HasSubstr("1 simulated drive and the gateway"));
}

// A command with an id would be refused as a repetition when it is given a second time.
TEST(DemoGuide, GivesCommandsThatMayBeRepeated) {
  EXPECT_THAT(guide_of(test::demo_model()), Not(HasSubstr("\"id\"")));
}

TEST(DemoGuide, SpeaksTheControlWordsOfEachDrive) {
  const std::string guide = guide_of(test::demo_model());
  EXPECT_THAT(guide,
              HasSubstr("canopen/demo/hoist1/set -m '{\"frequency_command\":40.0,\"control_command\":1}'   # run"));
  EXPECT_THAT(guide, HasSubstr("canopen/demo/hoist1/control_command/set -m 7   # fault reset"));
  EXPECT_THAT(guide,
              HasSubstr("canopen/demo/mixer1/set -m '{\"target_velocity\":900.0,\"control_command\":127}'   # run"));
  EXPECT_THAT(guide, HasSubstr("canopen/demo/mixer1/control_command/set -m 128   # fault reset"));
  EXPECT_THAT(guide, HasSubstr("-a 7 -0 -t 4 -r 101 -1 127.0.0.1 4000   # frequency_command"));
}

// Of each drive its profile tells how it is tried: nothing of it stands in code.
TEST(DemoGuide, GivesTheStepsOfADriveThatHasStates) {
  EXPECT_THAT(guide_of(test::demo_model()),
              HasSubstr("mixer1/control_command/set -m 6   # before it runs\n"
                        "  mosquitto_pub -h 127.0.0.1 -p 1883 -t canopen/demo/mixer1/control_command/set -m 7   # "
                        "before it runs\n"));
}

TEST(DemoGuide, SaysNothingOfADriveThatNoProfileTellsHowToTry) {
  const config::Model model = test::demo_model();
  const std::vector<config::DriveNotes> nothing(model.drives.size());
  EXPECT_THAT(demo_guide(model, nothing),
              AllOf(HasSubstr("hoist1 (invt-goodrive600, node 7)"), Not(HasSubstr("# run"))));
}

TEST(DemoGuide, TripsByRawWriteOnlyWhereTheSiteAllowsIt) {
  const std::string guide = guide_of(test::demo_model());
  EXPECT_THAT(guide, HasSubstr("canopen/demo/pump1/sdo/request"));
  EXPECT_THAT(guide, Not(HasSubstr("canopen/demo/fan1/sdo/request")));
}

TEST(DemoGuide, LeavesOutWhatIsOff) {
  config::Model model = test::demo_model();
  model.mqtt.reset();
  EXPECT_THAT(guide_of(model), Not(HasSubstr("mosquitto")));
  model.modbus.reset();
  EXPECT_THAT(guide_of(model), Not(HasSubstr("mbpoll")));
}

}  // namespace
}  // namespace gateway
