#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <string_view>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::kUnit;
using modbus_test::Site;
using std::chrono::milliseconds;

constexpr std::uint8_t kFlat = 1;
constexpr std::uint16_t kStopWord = 5;

/// pump1 from 3000 on, and behind it fan1, which is out of service and has no unit of its own.
config::Model model() {
  config::Model model = example_model();
  model.modbus->flat_unit = kFlat;
  model.drives[0].flat = 3000;
  canopen::MotorSigns& motor = model.drives[0].node.motor;
  motor.control = modbus_test::kControlObject;
  motor.stops = {{0xFFFF, kStopWord}};
  config::Drive fan = model.drives[0];
  fan.name = "fan1";
  fan.unit.reset();
  fan.flat = 4000;
  fan.enabled = false;
  fan.node.node = 6;
  fan.on_stale = config::OnStale::hold;
  for (auto* const pdos : {&fan.node.tpdos, &fan.node.rpdos}) {
    for (canopen::PdoSettings& pdo : *pdos) {
      ++pdo.cob_id;
    }
  }
  model.drives.push_back(fan);
  return model;
}

class FlatUnit : public testing::Test {
 protected:
  FlatUnit() {
    site_.bring_up();
    site_.send_values(0x0001, 4997, -2);
    puppet().written.clear();
  }
  std::string ask(std::string_view pdu) { return site_.ask(site_.client(), kFlat, pdu); }
  support::Puppet& puppet() { return site_.puppet(); }

  Site site_{model()};
};

TEST_F(FlatUnit, ShowsADriveAtItsBase) {
  EXPECT_EQ(ask("03 0bb8 0003"), "03 06 0001 0000 1385");   // 3000..3002
  EXPECT_EQ(ask("04 0bba 0001"), "04 02 1385");             // 3002
  EXPECT_EQ(ask("03 0c80 0002"), "03 04 ffff fffe");        // position, 3200
  EXPECT_EQ(ask("01 0bb8 0004"), "01 01 01");               // running
  EXPECT_EQ(ask("03 0f3c 0003"), "03 06 0033 0005 0000");   // 3900: 1000..1002
  EXPECT_EQ(ask("03 0f3c 0064").size(), 6 + 100 * 5 - 1U);  // all of the diagnostics
  EXPECT_EQ(site_.ask("03 0002 0001"), "03 02 1385");       // and its own unit as ever
}

TEST_F(FlatUnit, ShowsWhatItsOwnUnitShows) {
  for (const char* const part : {"0000 0064", "0064 0064", "00c8 0006"}) {
    const unsigned address = 3000U + static_cast<unsigned>(std::stoul(std::string(part).substr(0, 4), nullptr, 16));
    std::string flat = "03 ";
    for (const unsigned shift : {12U, 8U, 4U, 0U}) {
      flat += "0123456789abcdef"[(address >> shift) & 0xFU];
    }
    EXPECT_EQ(ask(flat + std::string(part).substr(4)), site_.ask(std::string("03 ") + part)) << part;
  }
}

TEST_F(FlatUnit, AddressesOfNoDriveAreNotThere) {
  EXPECT_EQ(ask("03 0000 0001"), "83 02");
  EXPECT_EQ(ask("03 0bb7 0001"), "83 02");  // 2999
  EXPECT_EQ(ask("03 0bb7 0002"), "83 02");
  EXPECT_EQ(ask("03 1388 0001"), "83 02");  // 5000
  EXPECT_EQ(ask("03 1387 0002"), "83 02");  // 4999, 5000
  EXPECT_EQ(ask("03 0d48 0001"), "83 02");  // 3400: no signal there
  EXPECT_EQ(ask("01 0f3c 0001"), "81 02");  // diagnostics have no bits
  EXPECT_EQ(ask("03 ffff 0001"), "83 02");
  EXPECT_EQ(ask("06 0000 0001"), "86 02");
}

TEST_F(FlatUnit, AReadMayGoOverDrives) {
  // 3998, 3999 of pump1; 4000, 4001 of fan1, which holds what it has.
  EXPECT_EQ(ask("03 0f9e 0004"), "03 08 0000 0000 0000 0000");
  EXPECT_EQ(ask("03 1324 0003"), "03 06 0000 00ff 00ff");  // 4900: offline, unknown, not booted
}

TEST_F(FlatUnit, OneDriveThatIsNotFreshFailsTheWhole) {
  site_.run_without_values(milliseconds(700));
  EXPECT_EQ(ask("03 0bb8 0001"), "83 0b");
  EXPECT_EQ(ask("03 0fa0 0001"), "03 02 0000");
  EXPECT_EQ(ask("03 0f3c 0001").substr(0, 5), "03 02");
}

TEST_F(FlatUnit, WritesAsOnTheDrivesOwnUnit) {
  EXPECT_EQ(ask("10 0c1c 0002 04 0003 1388"), "10 0c1c 0002");  // 3100, 3101
  ASSERT_EQ(puppet().rpdos.size(), 1U);
  EXPECT_EQ(site_.ask("03 0064 0002"), "03 04 0003 1388");
  EXPECT_EQ(ask("03 0c1c 0002"), "03 04 0003 1388");
  EXPECT_EQ(ask("16 0c1c fff0 0001"), "16 0c1c fff0 0001");
  EXPECT_EQ(ask("03 0c1c 0001"), "03 02 0001");
  EXPECT_EQ(ask("06 0ce4 0007"), "06 0ce4 0007");  // acceleration, 3300
  EXPECT_EQ(ask("05 0bc2 ff00"), "05 0bc2 ff00");  // relay, bit 10
  EXPECT_EQ(ask("06 0c1d 1389"), "86 03");         // above its limit
  EXPECT_EQ(ask("06 0bb8 0001"), "86 02");         // a measured value
  EXPECT_EQ(ask("06 1004 0001"), "86 0b");         // of fan1, which is not there
  EXPECT_EQ(ask("17 0c1c 0001 0c1c 0001 02 0005"), "17 02 0005");
  site_.send_values(0, 0, 0);
  EXPECT_EQ(ask("06 0f50 0080"), "06 0f50 0080");  // 3920: NMT, pre-operational
  EXPECT_EQ(puppet().nmt_commands.back(), 0x80);
}

TEST_F(FlatUnit, OneRequestWritesOneDrive) {
  const std::size_t before = puppet().rpdos.size();
  EXPECT_EQ(ask("10 0f9f 0002 04 0001 0001"), "90 02");  // 3999, 4000
  EXPECT_EQ(ask("10 0f3b 0002 04 0001 0001"), "90 02");  // 3899, 3900
  EXPECT_TRUE(puppet().written.empty());
  EXPECT_EQ(puppet().rpdos.size(), before);
}

TEST_F(FlatUnit, IdentifiesTheGatewayAndReachesEveryNode) {
  EXPECT_EQ(ask("2b 0e 04 80"), site_.ask(site_.client(), 255, "2b 0e 04 80"));
  EXPECT_NE(ask("2b 0e 04 80"), site_.ask(site_.client(), kUnit, "2b 0e 04 80"));
  puppet().dictionary[{0x2FFF, 0}] = {.value = 7, .size = 1};
  EXPECT_EQ(ask("2b 0d 00 00 05 2fff 00 0000 0000"),
            site_.ask(site_.client(), 255, "2b 0d 00 00 05 2fff 00 0000 0000"));
  EXPECT_EQ(ask("2b 0d 00 00 06 2fff 00 0000 0000"), "ab 0b");  // out of service
  EXPECT_EQ(ask("2b 0d 00 00 07 2fff 00 0000 0000"), "ab 02");
}

TEST_F(FlatUnit, AStopIsOneThereToo) {
  site_.run_without_values(milliseconds(700));
  EXPECT_EQ(ask("17 0bb8 0001 0ce4 0001 02 0005"), "97 0b");
  EXPECT_TRUE(puppet().written.empty()) << "what cannot be read keeps a command back";
  EXPECT_EQ(ask("17 0bb8 0001 0c1c 0001 02 0005"), "97 0b");
  ASSERT_FALSE(puppet().written.empty()) << "but no stop";
  EXPECT_EQ(puppet().written.back().object, modbus_test::kControlObject);
  EXPECT_EQ(puppet().written.back().raw, kStopWord);
}

TEST(FlatUnitOff, IsNoUnit) {
  Site site;
  EXPECT_EQ(site.ask(site.client(), kFlat, "03 0bb8 0001"), "83 0a");
}

TEST(FlatUnitAccess, WhoMayNotWriteIsTold) {
  config::Model outside = model();
  outside.modbus->write_from = {{"192.0.2.0", 24}};
  Site site(std::move(outside));
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(site.ask(site.client(), kFlat, "06 0c1c 0005"), "86 01");
  EXPECT_EQ(site.ask(site.client(), kFlat, "10 0f9f 0002 04 0001 0001"), "90 01");
  EXPECT_TRUE(site.puppet().written.empty());

  config::Model none = model();
  none.drives[0].commands.writers = {};
  Site refusing(std::move(none));
  EXPECT_EQ(refusing.ask(refusing.client(), kFlat, "10 0f9f 0002 04 0001 0001"), "90 01");
}

TEST(FlatUnitAccess, TheWordOrderIsTheSame) {
  config::Model little = model();
  little.modbus->word_order = config::WordOrder::little;
  Site site(std::move(little));
  site.bring_up();
  site.send_values(0, 0, 0x00010002);
  site.send_slow_values(0, 1.0F, 1250);
  EXPECT_EQ(site.ask(site.client(), kFlat, "03 0c80 0002"), "03 04 0002 0001");
  EXPECT_EQ(site.ask(site.client(), kFlat, "03 0c84 0002"), "03 04 0000 42fa");  // 125.0 as a float
  EXPECT_EQ(site.ask(site.client(), kFlat, "03 0c84 0002"), site.ask("03 00cc 0002"));
}

}  // namespace
