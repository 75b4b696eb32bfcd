#include <gmock/gmock.h>

#include <chrono>
#include <map>

#include "tests/unit/config/shipped.h"

// The profiles as they are installed, held against the manuals' tables in data/ and against the fixed Modbus addresses.

namespace config {
namespace {

using canopen::FieldUse;
using canopen::SetupPolicy;
using std::chrono::milliseconds;

const std::map<std::string, std::uint16_t> kRegisters{
    {"status_word", 0},      {"fault_code", 1},        {"output_frequency", 2},    {"output_current", 3},
    {"motor_speed", 4},      {"output_torque", 5},     {"output_power", 6},        {"output_voltage", 7},
    {"input_voltage", 8},    {"dc_bus_voltage", 9},    {"module_temperature", 10}, {"actual_velocity", 11},
    {"velocity_demand", 12}, {"control_command", 100}, {"frequency_command", 101}, {"torque_command", 102},
    {"target_velocity", 103}};
const std::map<std::string, std::uint16_t> kBits{{"running", 0}, {"reverse", 1}, {"fault", 2},
                                                 {"warning", 3}, {"ready", 4},   {"remote", 5}};

struct Shipped {
  std::string profile;
  std::string stated;  ///< What the site has to state to be without a warning.
  std::string presets;
};

// GoogleTest looks for this name.  NOLINTNEXTLINE(readability-identifier-naming)
void PrintTo(const Shipped& shipped, std::ostream* out) {
  *out << shipped.profile;
}

const std::string kAssigned =
    "settings = { 1 = \"frequency_command\", 2 = \"torque_command\", 3 = \"unused\" }\n"
    "returns = { 1 = \"output_frequency\", 2 = \"output_current\", 3 = \"output_torque\", 4 = \"output_voltage\", 5 = "
    "\"output_power\", 6 = \"motor_speed\", 7 = \"fault_code\", 8 = \"dc_bus_voltage\" }\n"
    "tpdo2.unconfirmed = false\ntpdo3.unconfirmed = false\ntpdo4.unconfirmed = false\nrpdo2.unconfirmed = false\n";

const std::string kTried =
    "signals.output_torque.unconfirmed = false\nsignals.module_temperature.unconfirmed = false\n";

class ShippedProfiles : public testing::TestWithParam<Shipped> {};

TEST_P(ShippedProfiles, LoadWithoutAFinding) {
  const Loaded loaded = load_drive(GetParam().profile, GetParam().stated);
  EXPECT_TRUE(loaded.model.has_value());
  EXPECT_TRUE(loaded.findings.empty()) << lines(loaded.findings);
}

TEST_P(ShippedProfiles, HaveTheFixedAddresses) {
  const Drive drive = drive_of(GetParam().profile, GetParam().stated + GetParam().presets);
  for (const Signal& signal : drive.signals) {
    const bool is_bit = signal.type == canopen::DataType::boolean;
    const auto& places = is_bit ? kBits : kRegisters;
    const auto fixed = places.find(signal.name);
    EXPECT_EQ(signal.modbus.kind, is_bit ? ModbusKind::bit : ModbusKind::holding) << signal.name;
    if (fixed != places.end()) {
      EXPECT_EQ(signal.modbus.address, fixed->second) << signal.name;
    } else {
      EXPECT_GE(signal.modbus.address, 200) << signal.name;
      EXPECT_LT(signal.modbus.address, 1000) << signal.name;
    }
  }
  for (const auto& [name, address] : kBits) {
    const bool has_none = name == "remote" && drive.profile.starts_with("veichi");  // its status word tells none
    EXPECT_EQ(drive.find(name).has_value(), !has_none) << name;
  }
  EXPECT_TRUE(drive.faults.running.has_value());
  EXPECT_TRUE(drive.faults.fault.has_value());
  EXPECT_TRUE(drive.faults.warning.has_value());
}

TEST_P(ShippedProfiles, CommandByRpdoAndNeverReadCommandsBack) {
  const Drive drive = drive_of(GetParam().profile, GetParam().stated);
  const Signal& control = signal_of(drive, "control_command");
  EXPECT_EQ(control.access, Access::write);
  EXPECT_EQ(control.source.kind, SourceKind::rpdo);
  EXPECT_TRUE(!control.momentary.empty() || control.momentary_mask != 0);
  ASSERT_EQ(drive.node.rpdos.size(), 1U);
  for (const canopen::MappedObject& field : drive.node.rpdos[0].mapping) {
    EXPECT_NE(field.use, FieldUse::unnamed) << canopen::to_string(field.object);
  }
}

TEST_P(ShippedProfiles, HaveCyclicTpdosEveryHundredMilliseconds) {
  for (const canopen::PdoSettings& tpdo : drive_of(GetParam().profile, GetParam().stated).node.tpdos) {
    EXPECT_EQ(tpdo.period, milliseconds(100)) << tpdo.number;
    EXPECT_EQ(tpdo.cob_id, 0x180U + 0x100U * (tpdo.number - 1U) + 5U);
    EXPECT_EQ(tpdo.communication, SetupPolicy::write);
  }
}

TEST_P(ShippedProfiles, WriteNothingAtBootThatCouldMoveAMotor) {
  EXPECT_TRUE(drive_of(GetParam().profile, GetParam().stated + GetParam().presets).node.setup.empty());
}

INSTANTIATE_TEST_SUITE_P(
    All, ShippedProfiles,
    testing::Values(Shipped{"veichi-ac300", kTried, "presets = [\"veichi-command-codes\", \"veichi-limits\"]\n"},
                    Shipped{"veichi-ac310", kTried, "presets = [\"veichi-command-codes\", \"veichi-limits\"]\n"},
                    Shipped{"invt-goodrive600", kAssigned, "presets = [\"invt-command-codes\"]\n"},
                    Shipped{"vacon-opte6", "", "presets = [\"vacon-id-objects\"]\n"},
                    Shipped{"cia402-velocity", "", ""}));

class VeichiFaults : public testing::TestWithParam<const char*> {};

TEST_P(VeichiFaults, AreThoseOfTheManual) {
  const std::string name = GetParam();
  const FaultRules faults = drive_of("veichi-" + name).faults;
  std::size_t texts = 0;
  for (const auto& row : rows_of("veichi_" + name + "_faults.csv")) {
    const std::uint64_t code = hex(row.at(0));
    const bool named = code != 0 && row.at(1) != "Reserved";
    ASSERT_EQ(faults.drive_texts.contains(code), named) << row.at(0);
    if (named) {
      ++texts;
      EXPECT_EQ(faults.drive_texts.at(code).text, row.at(1));
      EXPECT_EQ(faults.drive_texts.at(code).severity, row.at(3) == "warning" ? Severity::warning : Severity::fault);
    }
  }
  EXPECT_EQ(faults.drive_texts.size(), texts);
}

INSTANTIATE_TEST_SUITE_P(Both, VeichiFaults, testing::Values("ac300", "ac310"));

TEST(Veichi, HasTheManualsPdos) {
  const Drive drive = drive_of("veichi-ac300");
  ASSERT_EQ(drive.node.tpdos.size(), 3U);
  const auto objects = [](const canopen::PdoSettings& pdo) {
    std::vector<std::string> list;
    for (const canopen::MappedObject& field : pdo.mapping) {
      list.push_back(canopen::to_string(field.object));
      EXPECT_EQ(field.bits, 16);
    }
    return list;
  };
  using testing::ElementsAre;
  EXPECT_THAT(objects(drive.node.tpdos[0]), ElementsAre("0x2030:03", "0x2021:03", "0x2021:02", "0x2021:06"));
  EXPECT_THAT(objects(drive.node.tpdos[1]), ElementsAre("0x2021:0B", "0x2021:04", "0x2030:04"));
  EXPECT_THAT(objects(drive.node.tpdos[2]), ElementsAre("0x2021:08", "0x2021:0C", "0x2021:05", "0x2021:0D"));
  EXPECT_THAT(objects(drive.node.rpdos.at(0)), ElementsAre("0x2030:02", "0x2030:01", "0x2030:06"));
  EXPECT_EQ(drive.node.emcy.layout, canopen::EmcyLayout::drive_code);
  EXPECT_TRUE(drive.node.sdo.accept_short_answers);
  EXPECT_TRUE(drive.node.sdo.accept_upload_style_write_answer);
  EXPECT_EQ(signal_of(drive, "status_word").publish_mask & 0x4000U, 0U);
}

TEST(Veichi, NamesNoCommandCodeUnlessTheSiteAsks) {
  EXPECT_TRUE(signal_of(drive_of("veichi-ac310"), "control_command").values.empty());
  const Loaded loaded = load_drive("veichi-ac310", kTried + "presets = [\"veichi-command-codes\"]\n");
  ASSERT_EQ(warnings_of(loaded).size(), 1U);
  EXPECT_THAT(warnings_of(loaded).front(), testing::HasSubstr("unconfirmed"));
  const Signal& control = signal_of(loaded.model->drives.at(0), "control_command");
  EXPECT_EQ(control.values.size(), 8U);
  EXPECT_FALSE(control.values.contains(8));
  EXPECT_TRUE(is_momentary(control, 7));
  EXPECT_TRUE(is_momentary(control, 3));
  EXPECT_FALSE(is_momentary(control, 1));
  EXPECT_FALSE(is_momentary(control, 5));
}

TEST(Goodrive600, NeverSendsItsRpdoUntilTheSiteStatesTheSettings) {
  const Loaded loaded = load_drive("invt-goodrive600");
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  const auto stated = testing::HasSubstr("not stated");
  EXPECT_THAT(warnings_of(loaded),
              testing::UnorderedElementsAre(stated, stated,
                                            testing::HasSubstr("not established for this drive: tpdo2, "
                                                               "rpdo2. Compare")));
  const Drive& drive = loaded.model->drives.at(0);
  ASSERT_EQ(drive.node.rpdos.size(), 1U);
  EXPECT_EQ(drive.node.rpdos[0].number, 2);
  EXPECT_EQ(drive.node.rpdos[0].mapping.at(2).use, FieldUse::unnamed);
  EXPECT_TRUE(signal_of(drive, "frequency_command").unconfirmed);
  ASSERT_EQ(drive.node.tpdos.size(), 1U);
  EXPECT_EQ(drive.node.tpdos[0].number, 2);
  EXPECT_EQ(drive.node.tpdos[0].mapping_policy, SetupPolicy::assume);
  EXPECT_EQ(drive.node.tpdos[0].transmission_type, 254);
  EXPECT_EQ(drive.node.tpdos[0].inhibit_time, 50) << "this card counts in milliseconds";
  EXPECT_EQ(drive.node.tpdos[0].event_timer, 100);
  EXPECT_EQ(drive.node.emcy.layout, canopen::EmcyLayout::class_and_vendor40);
  EXPECT_EQ(drive.faults.drive_texts.size(), 1U);
}

TEST(Goodrive600, UsesMoreTpdosWhereMoreReturnsAreNamed) {
  EXPECT_EQ(drive_of("invt-goodrive600", kAssigned).node.tpdos.size(), 4U - 1U);
}

TEST(Goodrive600, RunsInEitherDirectionAndWithPreExcitation) {
  const Drive drive = drive_of("invt-goodrive600", kAssigned);
  EXPECT_EQ(signal_of(drive, "running").derived->values, (std::vector<std::uint64_t>{1, 2, 6}));
  EXPECT_EQ(signal_of(drive, "running").derived->mask, 0xFFU);
}

}  // namespace
}  // namespace config
