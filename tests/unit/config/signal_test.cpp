#include <gmock/gmock.h>

#include <chrono>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using std::chrono::seconds;
using testing::HasSubstr;

// Two words in a TPDO, two in an RPDO.
const std::string kTwoPdos = R"(title = "a drive of the test"
[tpdo1]
map = ["0x2000:01 u16", "0x2000:02 i16"]
[rpdo1]
map = ["0x2001:01 u16", "0x2001:02 i16"]
[signals.status_word]
object = "0x2000:01"
type = "u16"
[signals.motor_speed]
object = "0x2000:02"
type = "i16"
scale = 0.25
unit = "rpm"
[signals.control_command]
object = "0x2001:01"
type = "u16"
access = "write"
[signals.target_velocity]
object = "0x2001:02"
type = "i16"
access = "write"
[signals.running]
from = "status_word"
mask = 0x0003
equals = [1, 2]
)";

std::string signal_error_with(std::string_view more) {
  return error_of(own_site(more), kTwoPdos);
}

Drive drive_with(std::string_view more) {
  return model_of(own_site(more), kTwoPdos).drives.at(0);
}

TEST(Signals, ComeFromTheirPdos) {
  const Drive drive = drive_with("");
  EXPECT_EQ(signal_of(drive, "status_word").source, (Source{SourceKind::tpdo, 1}));
  EXPECT_EQ(signal_of(drive, "control_command").source, (Source{SourceKind::rpdo, 1}));
  ASSERT_EQ(drive.node.rpdos.size(), 1U);
  for (const canopen::MappedObject& field : drive.node.rpdos[0].mapping) {
    EXPECT_EQ(field.use, canopen::FieldUse::commanded);
  }
  EXPECT_EQ(signal_of(drive_with("[drive.signals.status_word]\nsource = \"sdo\"\n"), "status_word").source,
            (Source{SourceKind::sdo, 0}));
}

TEST(Signals, StandInTheOrderOfTheirAddressesWordsFirst) {
  std::vector<std::string> names;
  for (const Signal& signal : drive_with("").signals) {
    names.push_back(signal.name);
  }
  EXPECT_THAT(names,
              testing::ElementsAre("status_word", "motor_speed", "control_command", "target_velocity", "running"));
}

TEST(Signals, KnowTheirDecimals) {
  const auto decimals = [](std::string_view scale) {
    return signal_of(drive_with("[drive.signals.motor_speed]\nscale = " + std::string(scale) + "\n"), "motor_speed")
        .decimals;
  };
  EXPECT_EQ(decimals("0.01"), 2U);
  EXPECT_EQ(decimals("0.1"), 1U);
  EXPECT_EQ(decimals("1"), 0U);
  EXPECT_EQ(decimals("0.25"), 2U);
  EXPECT_EQ(decimals("10"), 0U);
  EXPECT_EQ(decimals("0.001"), 3U);
  EXPECT_EQ(decimals("12.5"), 1U);
}

TEST(Signals, CanBeOverriddenAndAdded) {
  const Drive drive = drive_with(R"([drive.signals.motor_speed]
scale = 0.5
deadband = 2
publish_mask = 0xFF
[drive.signals.target_velocity]
min = -10
max = 10.5
momentary = [-1]
[drive.signals.status_word]
values = { 0 = "off", 0x10 = "on" }
[drive.signals.ramp]
object = "0x2003:01"
type = "u32"
access = "read-write"
address = 202
poll = "5s"
)");
  const Signal& speed = signal_of(drive, "motor_speed");
  EXPECT_EQ(speed.scale, 0.5);
  EXPECT_EQ(speed.unit, "rpm");
  EXPECT_EQ(speed.deadband, 2.0);
  EXPECT_EQ(speed.publish_mask, 0xFFU);
  const Signal& target = signal_of(drive, "target_velocity");
  EXPECT_EQ(target.min, -10.0);
  EXPECT_EQ(target.max, 10.5);
  EXPECT_EQ(target.momentary, std::vector<std::uint64_t>{~std::uint64_t{0}});
  EXPECT_EQ(signal_of(drive, "status_word").values, (std::map<std::int64_t, std::string>{{0, "off"}, {16, "on"}}));
  const Signal& ramp = signal_of(drive, "ramp");
  EXPECT_EQ(ramp.source, (Source{SourceKind::sdo, 0}));
  EXPECT_EQ(ramp.access, Access::read_write);
  EXPECT_EQ(ramp.poll, seconds(5));
  EXPECT_EQ(ramp.modbus, (ModbusPlace{ModbusKind::holding, 202, 2, false}));
}

TEST(Signals, ASignOfTheSiteGoesIntoTheMapping) {
  const Drive drive = drive_with("[drive.signals.motor_speed]\ntype = \"u16\"\n");
  EXPECT_EQ(drive.node.tpdos.at(0).mapping.at(1).type, canopen::DataType::u16);
}

TEST(Signals, OfAnUnknownNameAreATypingMistakeOrNeedAnObject) {
  EXPECT_EQ(signal_error_with("[drive.signals.target_velocty]\nmax = 10\n"),
            "gateway.toml:7:16: error: drive \"a\": signal \"target_velocty\" is not in profile \"own\", where "
            "\"target_velocity\" is nearest; a signal of your own needs object and type");
}

TEST(Signals, CanBeLeftOut) {
  const Drive drive = drive_with("[drive.signals.motor_speed]\nenabled = false\n");
  EXPECT_EQ(drive.find("motor_speed"), std::nullopt);
  EXPECT_EQ(drive.node.tpdos.size(), 1U);
}

TEST(Signals, WhoseWordsAreAllLeftOutLeaveThePdoAlone) {
  const Drive drive = drive_with(
      "[drive.signals.motor_speed]\nenabled = false\n[drive.signals.status_word]\nenabled = "
      "false\n[drive.signals.running]\nenabled = false\n");
  EXPECT_TRUE(drive.node.tpdos.empty());
}

TEST(Signals, HaveNamesThatAreNoFixedTopics) {
  for (const std::string name : {"state", "status", "alarm", "nmt", "sdo", "set", "control", "history", "id"}) {
    EXPECT_THAT(signal_error_with("[drive.signals." + name + "]\nobject = \"0x1\"\ntype = \"u8\"\naddress = 300\n"),
                HasSubstr("the name is that of a fixed topic"));
  }
  EXPECT_THAT(signal_error_with("[drive.signals.Motor]\nobject = \"0x1\"\ntype = \"u8\"\naddress = 300\n"),
              HasSubstr("must be lower case letters"));
  EXPECT_THAT(
      signal_error_with("[drive.signals.status_word]\nvalues = { 0 = \"a\" }\n[drive.signals.status_word_code]\nobject "
                        "= \"0x1\"\ntype = \"u8\"\naddress = 300\n"),
      HasSubstr("it is the number of the enumerated \"status_word\""));
}

TEST(Limits, MustMakeSense) {
  EXPECT_THAT(signal_error_with("[drive.signals.target_velocity]\nmin = 5\nmax = 1\n"),
              HasSubstr("8:7: error: drive \"a\": signal \"target_velocity\" has min 5 above max 1"));
  EXPECT_THAT(signal_error_with("[drive.signals.target_velocity]\nmax = 40000\n"),
              HasSubstr("has a limit of 40000, which i16 with the scale 1 cannot hold"));
  EXPECT_THAT(signal_error_with("[drive.signals.motor_speed]\nmax = 10\n"), HasSubstr("cannot be written"));
  EXPECT_THAT(signal_error_with("[drive.signals.target_velocity]\nmax = nan\n"), HasSubstr("must be a finite number"));
  EXPECT_THAT(signal_error_with("[drive.signals.motor_speed]\nscale = 0\n"), HasSubstr("must be positive"));
  EXPECT_THAT(signal_error_with("[drive.signals.motor_speed]\ndeadband = -1\n"), HasSubstr("negative deadband"));
}

TEST(Enumerations, MustFitTheirType) {
  EXPECT_THAT(signal_error_with("[drive.signals.status_word]\nvalues = { 70000 = \"a\" }\n"),
              HasSubstr("names 70000, which does not fit u16"));
  EXPECT_THAT(signal_error_with("[drive.signals.status_word]\nvalues = { 1 = \"a\", 2 = \"a\" }\n"),
              HasSubstr("calls two values \"a\""));
  EXPECT_THAT(signal_error_with("[drive.signals.status_word]\nvalues = { 1 = \"a\", 0x1 = \"b\" }\n"),
              HasSubstr("names the number \"0x1\" twice"));
  EXPECT_THAT(signal_error_with("[drive.signals.status_word]\nvalues = { one = \"a\" }\n"),
              HasSubstr("which is no number"));
}

TEST(DerivedSignals, ReadAWordByMaskAndValues) {
  const Drive drive = drive_with(
      "[drive.signals.overspeed]\nfrom = \"status_word\"\nmask = 0x80\naddress = 200\n"
      "[drive.signals.reverse]\nfrom = \"motor_speed\"\nnegative = true\n");
  const Signal& running = signal_of(drive, "running");
  ASSERT_TRUE(running.derived.has_value());
  EXPECT_EQ(running.derived->from, drive.find("status_word"));
  EXPECT_EQ(running.derived->mask, 3U);
  EXPECT_EQ(running.derived->values, (std::vector<std::uint64_t>{1, 2}));
  EXPECT_EQ(running.type, canopen::DataType::boolean);
  EXPECT_EQ(running.source, (Source{SourceKind::tpdo, 1}));
  EXPECT_EQ(running.object, (canopen::ObjectAddress{0x2000, 1}));
  EXPECT_EQ(signal_of(drive, "overspeed").derived->values, std::vector<std::uint64_t>{0x80});
  EXPECT_TRUE(signal_of(drive, "reverse").derived->negative);
  EXPECT_EQ(drive.faults.running, drive.find("running"));
}

TEST(DerivedSignals, MustBeAbleToBeTrue) {
  const auto derived = [](std::string_view keys) {
    return signal_error_with("[drive.signals.x]\naddress = 200\n" + std::string(keys));
  };
  EXPECT_THAT(derived("from = \"status_wrd\"\nmask = 1\n"),
              HasSubstr("reads \"status_wrd\", which this drive does not have; nearest is \"status_word\""));
  EXPECT_THAT(derived("from = \"control_command\"\nmask = 1\n"), HasSubstr("must be a readable integer"));
  EXPECT_THAT(derived("from = \"running\"\nmask = 1\n"), HasSubstr("must be a readable integer"));
  EXPECT_THAT(derived("from = \"status_word\"\nnegative = true\n"), HasSubstr("must be a readable signed integer"));
  EXPECT_THAT(derived("from = \"status_word\"\nmask = 0x10000\n"), HasSubstr("has a mask wider than"));
  EXPECT_THAT(derived("from = \"status_word\"\nmask = 1\nequals = [2]\n"), HasSubstr("can never equal 0x0002"));
  EXPECT_THAT(derived("from = \"status_word\"\n"), HasSubstr("needs either mask or negative"));
  EXPECT_THAT(derived("from = \"status_word\"\nmask = 1\nobject = \"0x1\"\n"), HasSubstr("has no meaning beside from"));
  EXPECT_THAT(derived("from = \"status_word\"\nmask = 1\naccess = \"write\"\n"), HasSubstr("cannot be written"));
}

TEST(SpecialSignals, MustBeBooleans) {
  EXPECT_THAT(signal_error_with("[drive.signals.fault]\nobject = \"0x2005\"\ntype = \"u16\"\naddress = 300\n"),
              HasSubstr("signal \"fault\" must be a readable boolean"));
}

TEST(Momentary, IsAValueOrAMask) {
  const Drive drive = drive_with("[drive.signals.control_command]\nmomentary = [7]\nmomentary_mask = 0x80\n");
  const Signal& control = signal_of(drive, "control_command");
  EXPECT_TRUE(is_momentary(control, 7));
  EXPECT_TRUE(is_momentary(control, 0x8F));
  EXPECT_FALSE(is_momentary(control, 0x0F));
  EXPECT_THAT(signal_error_with("[drive.signals.control_command]\nmomentary = [-1]\n"), HasSubstr("does not fit u16"));
  EXPECT_THAT(signal_error_with("[drive.signals.motor_speed]\nmomentary = [7]\n"),
              HasSubstr("nothing of it is momentary"));
}

}  // namespace
}  // namespace config
