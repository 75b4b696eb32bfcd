// What `[drive.commands]` says of writers, leases and timeouts, and what a timeout may write.
#include <gmock/gmock.h>

#include <chrono>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kMotor = R"(title = "a drive of the test"
[rpdo1]
map = ["0x2001:01 u16", "0x2001:02 i16"]
[signals.status_word]
object = "0x2000:01"
type = "u16"
[signals.running]
from = "status_word"
mask = 1
[signals.control_command]
object = "0x2001:01"
type = "u16"
access = "write"
values = { 1 = "forward", 5 = "stop", 7 = "reset" }
momentary = [7]
stop = [5, 6]
[signals.torque_command]
object = "0x2001:02"
type = "i16"
access = "write"
scale = 0.1
max = 100
[signals.serial]
object = "0x2001:03"
type = "u64"
access = "write"
address = 200
[signals.brake]
object = "0x2001:04"
type = "bool"
access = "read-write"
address = 201
)";

std::string commands(std::string_view keys, std::string_view drive = "") {
  return kBus + "[[drive]]\nname = \"a\"\nnode = 1\nprofile = \"own\"\n" + std::string(drive) + "[drive.commands]\n" +
         std::string(keys);
}

Commands commands_with(std::string_view keys, std::string_view drive = "") {
  return model_of(commands(keys, drive), kMotor).drives.at(0).commands;
}

/// Name and raw value of what a timeout writes, in its order.
std::vector<std::pair<std::string, canopen::Raw>> written_by(std::string_view values) {
  const Model model =
      model_of(commands("timeout = \"1s\"\non_timeout = \"values\"\nvalues = " + std::string(values) + "\n"), kMotor);
  std::vector<std::pair<std::string, canopen::Raw>> written;
  for (const TimeoutValue& value : model.drives.at(0).commands.timeout_values) {
    written.emplace_back(model.drives.at(0).signals.at(value.signal).name, value.raw);
  }
  return written;
}

std::string values_error(std::string_view values) {
  return error_of(commands("timeout = \"1s\"\non_timeout = \"values\"\nvalues = " + std::string(values) + "\n"),
                  kMotor);
}

TEST(CommandKeys, AreTaken) {
  const Commands keys = commands_with(
      "writers = [\"local\"]\nlease = \"24h\"\ntimeout = \"5s\"\non_timeout = \"hold\"\nfeedback = \"2s\"\n");
  EXPECT_EQ(keys.writers, (Writers{.modbus = false, .mqtt = false, .local = true}));
  EXPECT_TRUE(keys.writers.any());
  EXPECT_EQ(keys.lease, hours(24));
  EXPECT_EQ(keys.timeout, seconds(5));
  EXPECT_EQ(keys.on_timeout, OnTimeout::hold);
  EXPECT_EQ(keys.feedback, seconds(2));
  EXPECT_FALSE(commands_with("").writers.any());
}

TEST(CommandKeys, HaveTheirRanges) {
  EXPECT_THAT(error_of(commands("lease = \"25h\"\n"), kMotor),
              HasSubstr("commands.lease \"25h\" is out of range 0s..24h"));
  EXPECT_THAT(error_of(commands("timeout = \"25h\"\n"), kMotor), HasSubstr("is out of range 0s..24h"));
  EXPECT_THAT(error_of(commands("feedback = \"61min\"\n"), kMotor), HasSubstr("is out of range 0s..1h"));
  EXPECT_THAT(error_of(commands("on_timeout = \"ceese\"\n"), kMotor), HasSubstr("nearest is \"cease\""));
}

TEST(TimeoutValues, AreInEngineeringUnitsOrNames) {
  EXPECT_THAT(written_by("{ control_command = 5 }"), ElementsAre(std::pair("control_command", 5U)));
  EXPECT_THAT(written_by("{ control_command = \"stop\" }"), ElementsAre(std::pair("control_command", 5U)));
  EXPECT_THAT(written_by("{ torque_command = -1.5, brake = true }"),
              ElementsAre(std::pair("torque_command", static_cast<canopen::Raw>(-15)), std::pair("brake", 1U)));
  EXPECT_THAT(written_by("{ serial = 9007199254740993 }"), ElementsAre(std::pair("serial", 9007199254740993U)))
      << "exact, where a double is not";
}

TEST(TimeoutValues, BeginWithTheStop) {
  EXPECT_THAT(written_by("{ torque_command = 0, brake = false, control_command = 6 }"),
              ElementsAre(std::pair("control_command", 6U), std::pair("torque_command", 0U), std::pair("brake", 0U)));
}

TEST(TimeoutValues, AreCheckedLikeCommands) {
  EXPECT_THAT(values_error("{ torque_command = 100.1 }"),
              HasSubstr("10:29: error: drive \"a\": commands.values.torque_command is out of range -3276.8..100"));
  EXPECT_THAT(values_error("{ serial = -1 }"), HasSubstr("is out of range 0.."));
  EXPECT_THAT(values_error("{ torque_command = nan }"), HasSubstr("is not a number"));
  EXPECT_THAT(values_error("{ torque_command = \"none\" }"), HasSubstr("takes a number"));
  EXPECT_THAT(values_error("{ torque_command = true }"), HasSubstr("takes a number, not true or false"));
  EXPECT_THAT(values_error("{ torque_command = [1] }"), HasSubstr("must be a number or a name, not a list"));
  EXPECT_THAT(values_error("{ status_word = 1 }"),
              HasSubstr("10:12: error: drive \"a\": commands.values.status_word cannot be written"));
  EXPECT_THAT(values_error("{ running = true }"), HasSubstr("commands.values.running cannot be written"));
  EXPECT_THAT(values_error("{ torqe_command = 1 }"),
              HasSubstr("is no signal of this drive; nearest is \"torque_command\""));
  EXPECT_THAT(values_error("{ control_command = \"stopp\" }"),
              HasSubstr("\"stopp\" is not known; nearest is \"stop\""));
  EXPECT_THAT(values_error("[5]"), HasSubstr("commands.values must be a table such as"));
}

TEST(TimeoutValues, StopOrAreSetPointsOnly) {
  EXPECT_THAT(
      values_error("{ control_command = 1 }"),
      HasSubstr("commands.values.control_command must be a value that only ever stops; stops are 0x0005, 0x0006"));
  EXPECT_THAT(values_error("{ control_command = \"forward\" }"), HasSubstr("must be a value that only ever stops"));
  EXPECT_THAT(values_error("{ control_command = 7 }"), HasSubstr("must be a value that only ever stops"));
  EXPECT_THAT(error_of(commands("timeout = \"1s\"\non_timeout = \"values\"\nvalues = { torque_command = 2.5 }\n",
                                "signals.torque_command.momentary = [25]\n"),
                       kMotor),
              HasSubstr("commands.values.torque_command must be no momentary value"));
  EXPECT_THAT(error_of(commands("timeout = \"1s\"\non_timeout = \"values\"\nvalues = { control_command = 5 }\n",
                                "signals.control_command.stop = []\n"),
                       kMotor),
              HasSubstr("no stop of this drive is known"));
}

TEST(Timeouts, NeedSomethingToDo) {
  EXPECT_THAT(error_of(commands("timeout = \"1s\"\non_timeout = \"values\"\n"), kMotor),
              HasSubstr("9:14: error: drive \"a\": commands.on_timeout = \"values\" needs values to write"));
  EXPECT_THAT(values_error("{}"), HasSubstr("needs values to write"));
  EXPECT_THAT(warnings_of(load_site(commands("timeout = \"1s\"\nvalues = { control_command = 5 }\n"), kMotor)),
              Contains(HasSubstr("9:10: warning: drive \"a\": commands.values are never written")));
  EXPECT_THAT(warnings_of(load_site(commands("on_timeout = \"values\"\nvalues = { control_command = 5 }\n"), kMotor)),
              Contains(HasSubstr("commands.on_timeout never acts without timeout")));
}

TEST(Timeouts, CeaseOnlyWhereTheDriveSupervisesAnRpdoThatIsSent) {
  const std::string cease = "timeout = \"1s\"\non_timeout = \"cease\"\n";
  EXPECT_EQ(commands_with(cease, "rpdo1 = { supervised = true, event_timer = \"300ms\" }\n").on_timeout,
            OnTimeout::cease);
  for (const std::string rpdo : {"", "rpdo1.supervised = true\n", "rpdo1.event_timer = \"300ms\"\n",
                                 "rpdo1 = { supervised = true, event_timer = \"0s\" }\n",
                                 "rpdo1 = { supervised = true, event_timer = \"300ms\" }\n"
                                 "signals.torque_command.enabled = false\n"}) {
    EXPECT_THAT(error_of(commands(cease, rpdo), kMotor), HasSubstr("\"cease\" stops nothing")) << rpdo;
  }
}

TEST(Feedback, NeedsToKnowWhatRunsAndWhatStops) {
  EXPECT_THAT(error_of(commands("feedback = \"1s\"\n", "signals.running.enabled = false\n"), kMotor),
              HasSubstr("9:12: error: drive \"a\": commands.feedback needs a signal \"running\""));
  EXPECT_THAT(error_of(commands("feedback = \"1s\"\n", "signals.control_command.stop = []\n"), kMotor),
              HasSubstr("commands.feedback needs stop values of control_command"));
}

TEST(Drives, AreInServiceUnlessTheSiteSaysOtherwise) {
  EXPECT_TRUE(model_of(commands(""), kMotor).drives.at(0).enabled);
  const Drive drive = model_of(commands("", "enabled = false\n"), kMotor).drives.at(0);
  EXPECT_FALSE(drive.enabled);
  EXPECT_EQ(drive.unit, 1);
  EXPECT_THAT(
      error_of(commands("", "enabled = false\n") + "[[drive]]\nname = \"b\"\nnode = 2\nunit = 1\nprofile = \"own\"\n",
               kMotor),
      HasSubstr("Modbus unit 1 is that of drive \"a\""))
      << "its unit stays its own";
}

TEST(StopAdvice, IsGivenWhereNoStopIsKnown) {
  const auto warned = [](const std::string& drive, const std::string& keys = "writers = [\"local\"]\n") {
    return warnings_of(load_site(commands(keys, drive), kMotor));
  };
  const auto none = HasSubstr("no value of control_command is known that only stops");
  EXPECT_THAT(warned(""), Not(Contains(none)));
  EXPECT_THAT(warned("signals.control_command.stop = []\n"), Contains(none));
  EXPECT_THAT(warned("signals.control_command.stop = []\n", ""), Not(Contains(none))) << "nobody commands it";
  EXPECT_THAT(warned("signals.control_command = { stop = [], stop_masks = [{ mask = 7, equals = 5 }] }\n"),
              Contains(HasSubstr("a stop for all leaves the drive out, because stop_masks name no exact value")));
  EXPECT_THAT(warned("signals.control_command = { stop = [], stop_masks = [{ mask = 0xFFFF, equals = 5 }] }\n"),
              Not(Contains(HasSubstr("a stop for all"))));
}

TEST(LocalWriters, NeedTheControlSocket) {
  const auto warned = [](const std::string& gateway) {
    return warnings_of(load_site(gateway + commands("writers = [\"local\"]\n"), kMotor));
  };
  EXPECT_THAT(warned(""), Not(Contains(HasSubstr("names local"))));
  EXPECT_THAT(warned("[gateway]\ncontrol = \"\"\n"),
              Contains(HasSubstr("commands.writers names local, but gateway.control is empty")));
}

TEST(SupervisionAdvice, CountsATimeoutThatDoesSomething) {
  const auto warned = [](const std::string& keys) {
    return warnings_of(load_site(commands("writers = [\"local\"]\n" + keys), kMotor));
  };
  const auto nothing = HasSubstr("nothing stops it when writer or gateway is gone");
  EXPECT_THAT(warned(""), Contains(nothing));
  EXPECT_THAT(warned("timeout = \"1s\"\n"), Contains(nothing));
  EXPECT_THAT(warned("timeout = \"1s\"\non_timeout = \"values\"\nvalues = { control_command = 5 }\n"),
              Not(Contains(nothing)));
}

TEST(Edges, AreMomentaryValuesOfTheControlCommand) {
  const auto edge_of = [](const std::string& drive) {
    return signal_of(model_of(commands("", drive), kMotor).drives.at(0), "control_command").edge;
  };
  EXPECT_THAT(edge_of(""), IsEmpty());
  EXPECT_THAT(edge_of("signals.control_command.edge = [7]\n"), ElementsAre(7U));
  EXPECT_THAT(edge_of("signals.control_command = { momentary_mask = 0x80, edge = [0x80, 7] }\n"),
              ElementsAre(0x80U, 7U));
  EXPECT_THAT(error_of(commands("", "signals.control_command.edge = [5]\n"), kMotor),
              HasSubstr("has the edge value 0x0005, which is not momentary"));
  EXPECT_THAT(error_of(commands("", "signals.control_command.edge = [65536]\n"), kMotor),
              HasSubstr("does not fit u16"));
  EXPECT_THAT(error_of(commands("", "signals.torque_command.edge = [1]\n"), kMotor),
              HasSubstr("has edge, which is for control_command alone"));
  EXPECT_THAT(error_of(commands("", "signals.running.edge = [1]\n"), kMotor), HasSubstr("has no meaning beside from"));
}

}  // namespace
}  // namespace config
