// What a drive's configuration says of its motor: what is read by SDO before it is started again or sent
// pre-operational.
#include <gmock/gmock.h>

#include <algorithm>

#include "tests/unit/config/shipped.h"

namespace config {
namespace {

using canopen::MotorSign;
using canopen::MotorSigns;
using canopen::ObjectAddress;
using canopen::StopWord;
using testing::ElementsAre;
using testing::IsEmpty;

bool only_stops(const MotorSigns& motor, canopen::Raw word) {
  return std::any_of(motor.stops.begin(), motor.stops.end(),
                     [word](const StopWord& stop) { return (word & stop.mask) == stop.equals; });
}

TEST(Motor, IsReadWhereItsSignalsAreReadOutOf) {
  const MotorSigns motor = drive_of("cia402-velocity").node.motor;
  EXPECT_EQ(motor.running,
            (MotorSign{.object = {0x6041, 0}, .mask = 0x006F, .values = {0x27, 0x07, 0x0F, 0x2F}, .negative = false}));
  EXPECT_EQ(motor.fault, (MotorSign{.object = {0x6041, 0}, .mask = 0x004F, .values = {0x08, 0x0F}}));
  EXPECT_EQ(motor.control, (ObjectAddress{0x6040, 0}));
  EXPECT_EQ(motor.control_type, canopen::DataType::u16);
}

TEST(Motor, MayHaveBooleansOfItsOwnAndSigns) {
  const std::string own = R"(title = "Own"
[signals.running]
object = "0x2000:01"
type = "bool"
[signals.speed]
object = "0x2000:02"
type = "i32"
address = 200
[signals.fault]
from = "speed"
negative = true
[signals.control_command]
object = "0x2000:03"
type = "i8"
access = "write"
stop = [-1, 5]
)";
  const MotorSigns motor =
      model_of(kBus + "[[drive]]\nname = \"a\"\nnode = 5\nprofile = \"own\"\n", own).drives.at(0).node.motor;
  EXPECT_EQ(motor.running, (MotorSign{.object = {0x2000, 1}, .type = canopen::DataType::boolean, .values = {1}}));
  EXPECT_EQ(motor.fault,
            (MotorSign{.object = {0x2000, 2}, .type = canopen::DataType::i32, .mask = 0, .negative = true}));
  EXPECT_EQ(motor.control_type, canopen::DataType::i8);
  EXPECT_THAT(motor.stops, ElementsAre(StopWord{0xFF, 0xFF}, StopWord{0xFF, 5}));
}

TEST(Motor, IsUnknownWhereTheProfileDoesNotSay) {
  const MotorSigns motor =
      model_of(kBus + "[[drive]]\nname = \"a\"\nnode = 5\nprofile = \"own\"\n", "title = \"Own\"\n")
          .drives.at(0)
          .node.motor;
  EXPECT_EQ(motor, MotorSigns{});
}

TEST(Motor, OfADriveWhoseControlCommandIsSwitchedOffHasNoStop) {
  const MotorSigns motor = drive_of("cia402-velocity", "signals.control_command.enabled = false\n").node.motor;
  EXPECT_EQ(motor.control, std::nullopt);
  EXPECT_THAT(motor.stops, IsEmpty());
}

// CiA 402: what may stand in the controlword and still start nothing.
TEST(Stops, OfCia402AreDisableVoltageQuickStopAndShutdown) {
  for (const std::string profile : {"cia402-velocity", "vacon-opte6"}) {
    const MotorSigns motor = drive_of(profile).node.motor;
    EXPECT_EQ(motor.stops, (std::vector<StopWord>{{0xFFFF, 0x0006}, {0xF882, 0}, {0xF884, 0}, {0xF887, 0x0006}}));
    for (const canopen::Raw word : {0x0000U, 0x0002U, 0x0006U, 0x0004U, 0x000BU, 0x0036U, 0x0106U, 0x0776U, 0x007DU}) {
      EXPECT_TRUE(only_stops(motor, word)) << profile << " " << word;
    }
    for (const canopen::Raw word : {0x0007U, 0x000FU, 0x007FU, 0x017FU, 0x0080U, 0x0086U, 0x0806U, 0x8000U}) {
      EXPECT_FALSE(only_stops(motor, word)) << profile << " " << word;
    }
  }
}

// The manuals do not confirm the codes: nobody has stop values who does not ask for them.
TEST(Stops, OfUnconfirmedCodesComeWithTheirPresetsOnly) {
  for (const auto& [profile, preset] : {std::pair<std::string, std::string>{"veichi-ac300", "veichi-command-codes"},
                                        {"veichi-ac310", "veichi-command-codes"},
                                        {"invt-goodrive600", "invt-command-codes"}}) {
    EXPECT_THAT(drive_of(profile).node.motor.stops, IsEmpty()) << profile;
    const MotorSigns motor = drive_of(profile, "presets = [\"" + preset + "\"]\n").node.motor;
    EXPECT_THAT(motor.stops, ElementsAre(StopWord{0xFFFF, 5}, StopWord{0xFFFF, 6})) << profile;
    EXPECT_TRUE(motor.running.has_value() && motor.fault.has_value() && motor.control.has_value()) << profile;
  }
}

TEST(Stops, OfTheSiteReplaceThoseOfTheProfile) {
  const auto stops = [](const std::string& keys) {
    return drive_of("cia402-velocity", "[drive.signals.control_command]\n" + keys).node.motor.stops;
  };
  EXPECT_THAT(stops("stop = []\nstop_masks = []\n"), IsEmpty());
  EXPECT_THAT(stops("stop = [2]\nstop_masks = [{ mask = 0x87, equals = 6 }]\n"),
              ElementsAre(StopWord{0xFFFF, 2}, StopWord{0x87, 6}));
}

// What a stop for all sends.
TEST(Stops, BeginWithAnExactValue) {
  EXPECT_EQ(canopen::first_stop(drive_of("cia402-velocity").node.motor), 6U);
  EXPECT_EQ(canopen::first_stop(drive_of("vacon-opte6").node.motor), 6U);
  EXPECT_EQ(canopen::first_stop(drive_of("veichi-ac310").node.motor), std::nullopt);
  EXPECT_EQ(canopen::first_stop(drive_of("veichi-ac310", "presets = [\"veichi-command-codes\"]\n").node.motor), 5U);
  const auto of = [](canopen::DataType type, std::vector<StopWord> stops) {
    return canopen::first_stop(MotorSigns{.control_type = type, .stops = std::move(stops)});
  };
  EXPECT_EQ(of(canopen::DataType::i8, {{0xFF, 0xFF}}), ~canopen::Raw{0}) << "as the type holds it";
  EXPECT_EQ(of(canopen::DataType::u16, {{0xFF, 5}, {0xFFFF, 6}}), 6U) << "no mask is one value";
  EXPECT_EQ(of(canopen::DataType::u16, {}), std::nullopt);
}

TEST(Edges, OfCia402AreTheFaultReset) {
  for (const std::string profile : {"cia402-velocity", "vacon-opte6"}) {
    EXPECT_THAT(signal_of(drive_of(profile), "control_command").edge, ElementsAre(0x0080U)) << profile;
  }
  // Which of them act on the level is not known of these.
  for (const std::string profile : {"veichi-ac300", "veichi-ac310", "invt-goodrive600"}) {
    EXPECT_THAT(signal_of(drive_of(profile), "control_command").edge, IsEmpty()) << profile;
  }
}

TEST(Remote, IsBitFiveWhereTheStatusWordTellsIt) {
  for (const auto& [profile, mask] : {std::pair<std::string, std::uint64_t>{"cia402-velocity", 0x0200},
                                      {"vacon-opte6", 0x0200},
                                      {"invt-goodrive600", 0x6000}}) {
    const Drive drive = drive_of(profile);
    const Signal& remote = signal_of(drive, "remote");
    EXPECT_EQ(remote.modbus, (ModbusPlace{ModbusKind::bit, 5, 1, false})) << profile;
    EXPECT_EQ(drive.signals.at(remote.derived->from).name, "status_word") << profile;
    EXPECT_EQ(remote.derived->mask, mask) << profile;
  }
  EXPECT_EQ(signal_of(drive_of("invt-goodrive600"), "remote").derived->values, (std::vector<std::uint64_t>{0x4000}));
  for (const std::string profile : {"veichi-ac300", "veichi-ac310"}) {
    EXPECT_EQ(drive_of(profile).find("remote"), std::nullopt) << profile;
  }
}

TEST(Lives, AreAsTheProfileAndTheSiteSay) {
  const std::string own = "title = \"Own\"\nextends = \"cia402-velocity\"\nself_starting = true\n";
  const auto node = [&own](const std::string& more) {
    return model_of(kBus + "[[drive]]\nname = \"a\"\nnode = 5\nprofile = \"own\"\n" + more, own).drives.at(0).node;
  };
  EXPECT_TRUE(node("").self_starting);
  EXPECT_FALSE(node("").restart);
  EXPECT_FALSE(node("self_starting = false\n").self_starting);
  EXPECT_TRUE(node("restart = true\n").restart);
  EXPECT_FALSE(drive_of("cia402-velocity").node.self_starting);
}

}  // namespace
}  // namespace config
