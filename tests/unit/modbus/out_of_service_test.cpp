// A drive that is out of service keeps its unit and its addresses.
#include <gtest/gtest.h>

#include <chrono>
#include <string_view>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::Site;

config::Model out_of_service() {
  config::Model model = modbus_test::example_model();
  model.drives[0].enabled = false;
  model.drives[0].node.motor.control = modbus_test::kControlObject;
  model.drives[0].node.motor.stops = {{0xFFFF, 5}};
  return model;
}

TEST(ModbusOutOfService, ReadsAsStaleAndRefusesEveryWrite) {
  Site site(out_of_service());
  site.puppet().boot_up();
  site.run(std::chrono::seconds(3));
  EXPECT_EQ(site.ask("03 0000 0001"), "83 0b") << "status_word";
  EXPECT_EQ(site.ask("01 0000 0001"), "81 0b") << "running";
  EXPECT_EQ(site.ask("03 0064 0002"), "03 04 0000 0000") << "what was commanded";
  EXPECT_EQ(site.ask("03 0001 0001"), "03 02 0000") << "unused";
  EXPECT_EQ(site.ask("06 0064 0001"), "86 0b");
  EXPECT_EQ(site.ask("06 0064 0005"), "86 0b") << "a stop";
  EXPECT_EQ(site.ask("10 0064 0002 04 0001 1388"), "90 0b");
  EXPECT_EQ(site.ask("16 012c 0000 1234"), "96 0b");
  EXPECT_EQ(site.ask("06 03fc 0001"), "86 0b") << "NMT start";
  EXPECT_EQ(site.ask("06 0065 ffff"), "86 03") << "out of range is told first";
  EXPECT_TRUE(site.puppet().written.empty());
  EXPECT_TRUE(site.puppet().rpdos.empty());
  EXPECT_TRUE(site.puppet().nmt_commands.empty());
}

TEST(ModbusOutOfService, DiagnosticsSayOfflineWithoutAnAlarm) {
  Site site(out_of_service());
  site.puppet().boot_up();
  site.run(std::chrono::seconds(3));
  EXPECT_EQ(site.ask("03 03e8 0004"), "03 08 0000 00ff 00ff 0000");
  EXPECT_EQ(site.ask("03 03f0 0002"), "03 04 ffff ffff");
  EXPECT_EQ(site.ask(site.client(), 0, "03 0001 0003"), "03 06 0001 0000 0000") << "configured, online, with alarm";
  EXPECT_EQ(site.ask(site.client(), 0, "06 0014 0001"), "86 01") << "the stop for all leaves it out";
  EXPECT_TRUE(site.puppet().written.empty());
}

}  // namespace
