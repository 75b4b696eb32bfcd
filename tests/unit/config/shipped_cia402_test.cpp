#include <gmock/gmock.h>

#include <algorithm>

#include "tests/unit/config/shipped.h"

namespace config {
namespace {

using canopen::SetupPolicy;

TEST(Cia402, HasTheTextsOfTheStandard) {
  const FaultRules faults = drive_of("cia402-velocity").faults;
  for (const auto& row : rows_of("cia402_error_codes.csv")) {
    ASSERT_TRUE(faults.emcy_texts.contains(static_cast<std::uint16_t>(hex(row.at(0))))) << row.at(0);
    EXPECT_EQ(faults.emcy_texts.at(static_cast<std::uint16_t>(hex(row.at(0)))).text,
              row.at(1) + (row.size() > 2 ? "," + row.at(2) : ""));
  }
  for (auto row : rows_of("emcy_error_classes.csv")) {
    std::replace(row.at(0).begin() + 2, row.at(0).end(), 'x', '0');
    const auto code = static_cast<std::uint16_t>(hex(row.at(0)));
    EXPECT_EQ(faults.emcy_texts.contains(code), code != 0) << row.at(0);
  }
  EXPECT_EQ(find_emcy_text(faults, 0x2399)->text, "Current on the device output side");
}

TEST(Cia402, ForgetsAFaultReset) {
  const Drive drive = drive_of("cia402-velocity");
  const Signal& control = signal_of(drive, "control_command");
  EXPECT_TRUE(is_momentary(control, 0x80));
  EXPECT_TRUE(is_momentary(control, 0x8F));
  EXPECT_FALSE(is_momentary(control, 0x7F));
}

bool holds(const Signal& signal, std::uint64_t word) {
  const auto& values = signal.derived->values;
  return std::find(values.begin(), values.end(), word & signal.derived->mask) != values.end();
}

TEST(Cia402, TellsItsStates) {
  const Drive drive = drive_of("cia402-velocity");
  const auto& running = signal_of(drive, "running");
  const auto& fault = signal_of(drive, "fault");
  const auto& ready = signal_of(drive, "ready");
  EXPECT_TRUE(holds(running, 0x0637));  // operation enabled
  EXPECT_TRUE(holds(running, 0x0617));  // quick stop active: braking, or held energised
  EXPECT_TRUE(holds(running, 0x061F));  // fault reaction active
  EXPECT_TRUE(holds(running, 0x063F));
  EXPECT_FALSE(holds(running, 0x0633));  // switched on
  EXPECT_FALSE(holds(running, 0x0640));  // switch on disabled
  EXPECT_FALSE(holds(running, 0x0608));  // fault
  EXPECT_TRUE(holds(fault, 0x0608));
  EXPECT_TRUE(holds(fault, 0x0628));
  EXPECT_TRUE(holds(fault, 0x062F));
  EXPECT_FALSE(holds(fault, 0x0637));
  EXPECT_TRUE(holds(ready, 0x0631));
  EXPECT_TRUE(holds(ready, 0x0637));
  EXPECT_FALSE(holds(ready, 0x0640));
  EXPECT_TRUE(signal_of(drive, "reverse").derived->negative);
  ASSERT_TRUE(drive.faults.quick_stop) << "a run command given before it must not come back";
  EXPECT_TRUE(holds(drive.signals[*drive.faults.quick_stop], 0x0617));
  EXPECT_FALSE(holds(drive.signals[*drive.faults.quick_stop], 0x0637));
}

TEST(Opte6, MapsCia402ObjectsAndSupervisesNoRpdo) {
  const Drive drive = drive_of("vacon-opte6", "supervise_gateway = \"2s\"\n");
  ASSERT_EQ(drive.node.tpdos.size(), 1U);
  ASSERT_EQ(drive.node.rpdos.size(), 1U);
  EXPECT_EQ(drive.node.tpdos[0].mapping_policy, SetupPolicy::write);
  EXPECT_EQ(drive.node.tpdos[0].transmission_type, 255);
  EXPECT_EQ(drive.node.tpdos[0].event_timer, 100);
  EXPECT_EQ(drive.node.rpdos[0].event_timer, 0);
  EXPECT_EQ(drive.node.rpdos[0].mapping.size(), 2U);
  EXPECT_TRUE(drive.node.emcy.reset_counts_remaining);
  EXPECT_EQ(drive.node.emcy.drive_code_under, 0x1000);
  EXPECT_EQ(drive.find("fault_code"), std::nullopt);
  EXPECT_EQ(drive.find("output_current"), std::nullopt);
}

TEST(Opte6, PollsIdObjectsOnlyWhereTheSiteAsks) {
  const Loaded loaded = load_drive("vacon-opte6", "presets = [\"vacon-id-objects\"]\n");
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  EXPECT_EQ(warnings_of(loaded).size(), 1U);
  const Drive& drive = loaded.model->drives.at(0);
  const Signal& current = signal_of(drive, "output_current");
  EXPECT_EQ(current.object, (canopen::ObjectAddress{0x2103, 0}));
  EXPECT_EQ(current.source.kind, SourceKind::sdo);
  EXPECT_TRUE(current.unconfirmed);
  EXPECT_EQ(current.scale, 1.0) << "the scaling hangs on object 0x2005 of the drive";
  EXPECT_EQ(signal_of(drive, "fault_code").object, (canopen::ObjectAddress{0x2125, 0}));
}

}  // namespace
}  // namespace config
