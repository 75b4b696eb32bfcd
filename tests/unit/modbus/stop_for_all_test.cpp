// Register 20 of the gateway's unit: one stop for all drives that Modbus may command.
#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::frame;
using modbus_test::kControlObject;
using modbus_test::Site;
using modbus_test::TcpClient;
using std::chrono::milliseconds;

constexpr canopen::Raw kStop = 5;

config::Model model_that_stops() {
  config::Model model = example_model();
  canopen::MotorSigns& motor = model.drives[0].node.motor;
  motor.control = kControlObject;
  motor.stops = {{0xFFFF, kStop}};
  return model;
}

/// Another drive of the same kind that is not on the bus.
config::Drive absent_drive() {
  config::Drive drive = model_that_stops().drives[0];
  drive.name = "fan1";
  drive.unit = 6;
  drive.node.node = 6;
  drive.node.tpdos.clear();
  drive.node.rpdos.clear();
  for (config::Signal& signal : drive.signals) {
    signal.source = {};
  }
  return drive;
}

class StopForAll : public testing::TestWithParam<std::uint8_t> {
 protected:
  static std::string ask(Site& site, std::string_view pdu) { return site.ask(site.client(), GetParam(), pdu); }
  /// The same where the answer takes its time.
  static std::string ask_and_wait(Site& site, std::string_view pdu, milliseconds time) {
    const auto request = frame(GetParam(), pdu);
    EXPECT_EQ(site.client().send(request), request.size());
    site.settle();
    site.run_without_values(time);
    return site.answer(site.client());
  }
  static bool was_stopped(Site& site) {
    for (const canopen::ObjectValue& value : site.puppet().written) {
      if (value.object == kControlObject) {
        return value.raw == kStop;
      }
    }
    return false;
  }
};

TEST_P(StopForAll, SendsTheFirstStopAndReadsZero) {
  Site site(model_that_stops());
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(ask(site, "06 0014 0001"), "06 0014 0001");
  EXPECT_TRUE(was_stopped(site));
  EXPECT_EQ(ask(site, "03 0014 0001"), "03 02 0000");
  EXPECT_EQ(site.ask("03 0064 0001"), "03 02 0005");
  site.puppet().written.clear();
  EXPECT_EQ(ask(site, "10 0014 0001 02 ff00"), "10 0014 0001");
  EXPECT_TRUE(was_stopped(site)) << "the same stop again";
}

TEST_P(StopForAll, GoesByTheRpdoWhereThatIsComplete) {
  Site site(model_that_stops());
  site.bring_up();
  EXPECT_EQ(site.ask("10 0064 0002 04 0001 1388"), "10 0064 0002");
  site.puppet().rpdos.clear();
  EXPECT_EQ(ask(site, "06 0014 0001"), "06 0014 0001");
  ASSERT_EQ(site.puppet().rpdos.size(), 1U);
  EXPECT_EQ(site.puppet().rpdos[0].data[0], kStop);
  EXPECT_EQ(site.puppet().rpdos[0].data[2], 0x88);
}

TEST_P(StopForAll, TakesAnyValueButZeroByFunctions6And16Alone) {
  Site site(model_that_stops());
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(ask(site, "06 0014 0000"), "86 03");
  EXPECT_EQ(ask(site, "10 0014 0001 02 0000"), "90 03");
  EXPECT_EQ(ask(site, "10 0014 0002 04 0001 0001"), "90 02");
  EXPECT_EQ(ask(site, "10 0013 0002 04 0001 0001"), "90 02");
  EXPECT_EQ(ask(site, "16 0014 0000 0001"), "96 02");
  EXPECT_EQ(ask(site, "17 0000 0001 0014 0001 02 0001"), "97 02");
  EXPECT_EQ(ask(site, "05 0014 ff00"), "85 02");
  EXPECT_EQ(ask(site, "06 0015 0001"), "86 02");
  EXPECT_TRUE(site.puppet().written.empty());
  EXPECT_TRUE(site.puppet().rpdos.empty());
}

TEST_P(StopForAll, TellsThatADriveDidNotConfirm) {
  config::Model model = model_that_stops();
  model.drives.push_back(absent_drive());
  Site site(model);
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(ask_and_wait(site, "06 0014 0001", milliseconds(1000)), "86 0b");
  EXPECT_TRUE(was_stopped(site)) << "it waits for no other";
}

TEST_P(StopForAll, TellsThatOfADriveNoStopIsKnown) {
  Site site(example_model());
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(ask(site, "06 0014 0001"), "86 0b");
  EXPECT_TRUE(site.puppet().written.empty());
}

TEST_P(StopForAll, LeavesDrivesAloneThatModbusMayNotCommandOrThatAreOutOfService) {
  config::Model model = model_that_stops();
  config::Drive other = absent_drive();
  other.commands.writers = {.modbus = false, .mqtt = true, .local = true};
  model.drives.push_back(other);
  other = absent_drive();
  other.name = "fan2";
  other.unit = 7;
  other.node.node = 7;
  other.enabled = false;
  model.drives.push_back(other);
  Site site(model);
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(ask(site, "06 0014 0001"), "06 0014 0001");
  EXPECT_TRUE(was_stopped(site));
}

TEST_P(StopForAll, NeedsAClientThatMayWrite) {
  config::Model model = model_that_stops();
  model.modbus->write_from = {{"192.0.2.0", 24}};
  Site site(model);
  site.bring_up();
  site.puppet().written.clear();
  EXPECT_EQ(ask(site, "06 0014 0001"), "86 01");
  EXPECT_TRUE(site.puppet().written.empty());
}

INSTANTIATE_TEST_SUITE_P(BothUnits, StopForAll, testing::Values(std::uint8_t{0}, std::uint8_t{255}));

}  // namespace
