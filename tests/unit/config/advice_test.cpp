#include <gmock/gmock.h>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const std::string kMixer = "[[drive]]\nname = \"mixer1\"\nnode = 9\nprofile = \"vacon-opte6\"\n";
const std::string kSupervised = kMixer + "supervise_gateway = \"2s\"\nerror_control.unconfirmed = false\n";
const std::string kCommands = "[drive.commands]\nwriters = [\"mqtt\"]\n";
const std::string kMqtt = "[mqtt]\n";
const std::string kMax = "[drive.signals.target_velocity]\nmax = 1500\n" + kMqtt;

TEST(Advice, IsNotNeededForADriveThatIsOnlyWatched) {
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer)), IsEmpty());
}

TEST(Advice, WarnsWhereADriveThatOnlyAnswersHasTimeForNoMissingAnswer) {
  const std::string none = kBus + kMixer + "heartbeat = \"0s\"\n";
  EXPECT_THAT(warnings_of(load_site(none)), IsEmpty()) << "the defaults are three times";
  EXPECT_THAT(warnings_of(load_site(none + "heartbeat_timeout = \"1499ms\"\n")),
              ElementsAre(HasSubstr("heartbeat_timeout (1499ms) is below three times sdo.timeout (500ms)")));
  EXPECT_THAT(warnings_of(load_site(none + "sdo = { timeout = \"501ms\" }\n")),
              ElementsAre(HasSubstr("7:13: warning: drive \"mixer1\": heartbeat_timeout (1500ms) is below")));
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + "sdo = { timeout = \"1s\" }\n")), IsEmpty())
      << "a heartbeat does not hang on it";
}

TEST(Advice, WarnsOfCommandsThatNobodySupervises) {
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + kCommands + kMax)),
              ElementsAre(HasSubstr("3:1: warning: drive \"mixer1\": takes commands, but nothing stops it")));
  EXPECT_THAT(warnings_of(load_site(kBus + kSupervised + kCommands + kMax)), IsEmpty());
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + "rpdo1 = { event_timer = \"1s\" }\n" + kCommands + kMax)),
              IsEmpty());
}

TEST(Advice, DoesNotRelyOnASupervisionThatNobodyHasTried) {
  const std::string hoped = "supervise_gateway = \"2s\"\n";
  const auto is_warned_of =
      ElementsAre(HasSubstr("3:1: warning: drive \"mixer1\": takes commands, and supervises the gateway, but it is not "
                            "established that its motor stops"));
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + hoped + kCommands + kMax)), is_warned_of);
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + hoped + kCommands + "timeout = \"1s\"\n" + kMax)), is_warned_of)
      << "on_timeout is hold";
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + hoped + "rpdo1 = { event_timer = \"1s\" }\n" + kCommands + kMax)),
              IsEmpty())
      << "which is established";
  EXPECT_THAT(warnings_of(load_site(kBus + kMixer + hoped)), IsEmpty()) << "nobody commands it";
}

TEST(Advice, CountsAnEventTimerOnlyWhereTheDriveIsKnownToHaveIt) {
  const std::string fan = "[[drive]]\nname = \"fan1\"\nnode = 3\nprofile = \"cia402-velocity\"\n";
  EXPECT_THAT(warnings_of(load_site(kBus + fan + "rpdo1 = { event_timer = \"300ms\" }\n" + kCommands + kMax)),
              ElementsAre(HasSubstr("nothing stops it when writer or gateway is gone")));
  EXPECT_THAT(warnings_of(load_site(kBus + fan + "rpdo1 = { event_timer = \"300ms\", supervised = true }\n" +
                                    kCommands + kMax)),
              IsEmpty());
}

TEST(Advice, CountsNoRpdoThatIsNeverSent) {
  const auto warned = [](const std::string& more) {
    const auto warnings = warnings_of(load_site(kBus + kMixer + more + kCommands + kMqtt));
    return std::any_of(warnings.begin(), warnings.end(),
                       [](const std::string& text) { return text.find("nothing stops it") != std::string::npos; });
  };
  const std::string timer = "rpdo1.event_timer = \"300ms\"\n";
  EXPECT_FALSE(warned(timer));
  EXPECT_TRUE(warned(timer + "signals.control_command.source = \"sdo\"\nsignals.target_velocity.source = \"sdo\"\n"));
  EXPECT_TRUE(warned(timer + "rpdo1.unused = [\"control_command\", \"target_velocity\"]\n"));
  EXPECT_TRUE(warned(timer + "rpdo1.map = [\"0x6040 u16\", \"0x6042 i16\", \"0x6060 i8\"]\n"))
      << "one field is unnamed";
  EXPECT_TRUE(warned("rpdo2 = { supervised = true, event_timer = \"300ms\", map = [\"0x6060 i8\"] }\n"));
}

TEST(Advice, WarnsOfWritersThatCannotReachTheDrive) {
  const auto warning = [](const std::string& modbus, const std::string& drive = "") {
    const Loaded loaded = load_site(kBus + kSupervised + drive + "[drive.commands]\nwriters = [\"modbus\"]\n" +
                                    "[drive.signals.target_velocity]\nmax = 1500\n" + modbus);
    std::string text;
    for (const std::string& each : warnings_of(loaded)) {
      text += each.find("commands.writers names modbus") != std::string::npos ? each : "";
    }
    return text;
  };
  EXPECT_EQ(warning("[modbus]\n"), "");
  EXPECT_THAT(warning(""), HasSubstr("there is no [modbus]"));
  EXPECT_THAT(warning("[modbus]\n", "unit = \"none\"\n"), HasSubstr("unit = \"none\""));
  EXPECT_THAT(warning("[modbus]\nwrite_from = []\n"), HasSubstr("write_from is empty"));
  EXPECT_THAT(warning("[modbus]\nread_from = [\"10.0.0.0/8\"]\n"), HasSubstr("can connect"));
  EXPECT_THAT(warning("[modbus]\nwrite_from = [\"fd00::/8\"]\n"), HasSubstr("can connect"));
  EXPECT_THAT(warning("[modbus]\nlisten = [\"127.0.0.1:502\"]\nwrite_from = [\"192.168.1.0/24\"]\n"),
              HasSubstr("can connect"));
  EXPECT_EQ(warning("[modbus]\nlisten = [\"192.168.1.2:502\"]\nwrite_from = [\"192.168.1.0/24\"]\n"), "");
}

TEST(Advice, WarnsOfADeadlineThatOneUnansweredReadUsesUp) {
  const std::string& supervised = kSupervised;
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + kCommands + "deadline = \"500ms\"\n" + kMax)),
              ElementsAre(HasSubstr("11:12: warning: drive \"mixer1\": commands.deadline (500ms) is below twice "
                                    "sdo.timeout (500ms)")));
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + kCommands + "deadline = \"999ms\"\n" + kMax)),
              ElementsAre(HasSubstr("commands.deadline (999ms) is below twice sdo.timeout (500ms)")));
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + kCommands + "deadline = \"800ms\"\n" + kMax)),
              ElementsAre(HasSubstr("commands.deadline (800ms) is below twice")))
      << "also where it is the default, once somebody states it";
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + kCommands + kMax)), IsEmpty());
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + kCommands + "deadline = \"1s\"\n" + kMax)), IsEmpty());
  EXPECT_THAT(warnings_of(load_site(kBus + supervised + "sdo = { timeout = \"1s\" }\n" + kCommands + kMax)),
              ElementsAre(HasSubstr("3:1: warning: drive \"mixer1\": commands.deadline (800ms) is below twice "
                                    "sdo.timeout (1s)")));
}

TEST(Advice, WarnsOfASetpointWithoutMax) {
  EXPECT_THAT(warnings_of(load_site(kBus + kSupervised + kCommands + kMqtt)),
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
      UnorderedElementsAre(HasSubstr("nothing stops it"), HasSubstr("no value of control_command is known"),
                           HasSubstr("rpdo2 is never sent, because nothing says what its field 0x2100:04 is for")));
}

}  // namespace
}  // namespace config
