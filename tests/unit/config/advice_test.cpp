#include <gmock/gmock.h>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const std::string kMixer = "[[drive]]\nname = \"mixer1\"\nnode = 9\nprofile = \"vacon-opte6\"\n";
const std::string kCommands = "[drive.commands]\nwriters = [\"mqtt\"]\n";
const std::string kMqtt = "[mqtt]\n";
const std::string kMax = "[drive.signals.target_velocity]\nmax = 1500\n" + kMqtt;

TEST(Advice, IsNotNeededForADriveThatIsOnlyWatched) {
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer)), IsEmpty());
}

TEST(Advice, WarnsOfCommandsThatNobodySupervises) {
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + kCommands + kMax)),
              ElementsAre(HasSubstr("3:1: warning: drive \"mixer1\": takes commands, but nothing stops it")));
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + "supervise_gateway = \"2s\"\n" + kCommands + kMax)), IsEmpty());
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + "rpdo1 = { event_timer = \"1s\" }\n" + kCommands + kMax)),
              IsEmpty());
}

TEST(Advice, CountsAnEventTimerOnlyWhereTheDriveIsKnownToHaveIt) {
  const std::string fan = "[[drive]]\nname = \"fan1\"\nnode = 3\nprofile = \"cia402-velocity\"\n";
  EXPECT_THAT(warnings_of(load_site(kBus + fan + "rpdo1 = { event_timer = \"300ms\" }\n" + kCommands + kMax)),
              ElementsAre(HasSubstr("nothing stops it when writer or gateway is gone")));
  EXPECT_THAT(warnings_of(load_site(kBus + fan + "rpdo1 = { event_timer = \"300ms\", supervised = true }\n" +
                                    kCommands + kMax)),
              IsEmpty());
}

TEST(Advice, WarnsOfADeadlineThatOneUnansweredReadUsesUp) {
  const std::string supervised = kMixer + "supervise_gateway = \"2s\"\n";
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + kCommands + "deadline = \"500ms\"\n" + kMax)),
              ElementsAre(HasSubstr("10:12: warning: drive \"mixer1\": commands.deadline (500ms) is below twice "
                                    "sdo.timeout (500ms)")));
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + kCommands + "deadline = \"999ms\"\n" + kMax)),
              ElementsAre(HasSubstr("commands.deadline (999ms) is below twice sdo.timeout (500ms)")));
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + kCommands + "deadline = \"1s\"\n" + kMax)), IsEmpty());
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + "sdo = { timeout = \"1s\" }\n" + kCommands + kMax)),
              ElementsAre(HasSubstr("3:1: warning: drive \"mixer1\": commands.deadline (800ms) is below twice "
                                    "sdo.timeout (1s)")));
}

TEST(Advice, WarnsOfASetpointWithoutMax) {
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + "supervise_gateway = \"2s\"\n" + kCommands + kMqtt)),
              ElementsAre(HasSubstr("set-point \"target_velocity\" has no max")));
}

TEST(Advice, WarnsOfZeroForWhatIsNotFresh) {
  const Loaded loaded = load_site(kBus + kMixer + "on_stale = \"zero\"\n");
  EXPECT_TRUE(loaded.model.has_value());
  EXPECT_THAT(warnings_of(loaded), ElementsAre(HasSubstr("7:12: warning: drive \"mixer1\": on_stale = \"zero\"")));
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + "[modbus]\non_stale = \"zero\"\n")),
              ElementsAre(HasSubstr("8:12: warning: modbus.on_stale = \"zero\"")));
}

TEST(Advice, WarnsOfAnRpdoThatIsNeverSent) {
  const std::string hoist =
      "[[drive]]\nname = \"hoist1\"\nnode = 7\nprofile = \"invt-goodrive600\"\n"
      "returns = { 1 = \"output_frequency\" }\nsettings = { 1 = \"frequency_command\" }\n"
      "tpdo2.unconfirmed = false\nrpdo2.unconfirmed = false\n";
  const std::string limits = "[drive.signals.frequency_command]\nmax = 50\n";
  EXPECT_THAT(
      warnings_of(load_site(kBus + hoist + kCommands + limits + kMqtt)),
      UnorderedElementsAre(HasSubstr("nothing stops it"),
                           HasSubstr("rpdo2 is never sent, because nothing says what its field 0x2100:04 is for")));
}

}  // namespace
}  // namespace config
