#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

#include "tests/support/spawn.h"
#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::Site;
using std::chrono::milliseconds;
using support::Puppet;

class MaskWrites : public testing::Test {
 protected:
  MaskWrites() {
    site_.bring_up();
    puppet().written.clear();
  }
  Puppet& puppet() { return site_.puppet(); }
  std::string ask(std::string_view pdu) { return site_.ask(pdu); }
  /// 1, by another client.
  support::Spawned<process::Outcome> another_writes(std::string_view signal) {
    process::Drive& drive = site_.plant().drive(0);
    return support::spawn(
        site_.loop().executor(),
        drive.write({.writer = {.way = process::Writer::Way::modbus, .address = "10.0.0.9"}},
                    {{static_cast<process::SignalId>(*drive.model().find(signal)), canopen::Raw{1}}}));
  }
  /// It has the SDO channel, as long as the drive is mute.
  support::Spawned<canopen::Result<canopen::Raw>> read_ramp() {
    return support::spawn(site_.loop().executor(),
                          site_.plant().drive(0).sdo_read(modbus_test::kRampObject, canopen::DataType::u16));
  }
  /// Sends a request that must wait for others before it.
  void expect_waiting(std::string_view pdu) {
    site_.settle();
    const modbus_test::Bytes request = modbus_test::frame(modbus_test::kUnit, pdu);
    ASSERT_EQ(site_.client().send(request), request.size());
    // What came later and from elsewhere is answered: so the server has looked at this one, too.
    modbus_test::TcpClient later(site_.port());
    EXPECT_EQ(site_.ask(later, modbus_test::kUnit, "03 0064 0001").substr(0, 5), "03 02");
    site_.client().receive();
    EXPECT_FALSE(site_.client().has_frame());
    EXPECT_FALSE(site_.client().closed());
  }

  Site site_;
};

TEST_F(MaskWrites, AMaskBuildsOnlyOnBitsThatSomebodyCommanded) {
  EXPECT_EQ(ask("16 0064 fff0 0003"), "96 03");  // nobody commanded the other bits
  EXPECT_TRUE(puppet().written.empty());
  EXPECT_TRUE(puppet().rpdos.empty());
  EXPECT_EQ(ask("10 0064 0002 04 0051 1388"), "10 0064 0002");
  EXPECT_EQ(ask("16 0064 fff0 0003"), "16 0064 fff0 0003");
  ASSERT_EQ(puppet().rpdos.size(), 2U);
  EXPECT_EQ(puppet().rpdos[1].data[0], 0x53);
  EXPECT_EQ(ask("03 0064 0001"), "03 02 0053");
}

TEST_F(MaskWrites, AMaskThatNamesEveryBitNeedsNoOther) {
  EXPECT_EQ(ask("16 012c 0000 1234"), "16 012c 0000 1234");
  ASSERT_EQ(puppet().written.size(), 1U);
  EXPECT_EQ(puppet().written[0].raw, 0x1234U);
}

TEST_F(MaskWrites, AMaskBuildsOnNoMomentaryValue) {
  EXPECT_EQ(ask("10 0064 0002 04 0080 0000"), "10 0064 0002");
  EXPECT_EQ(ask("16 0064 fffe 0001"), "96 03");
}

TEST_F(MaskWrites, AMaskCarriesNoCommandFromBeforeAStop) {
  EXPECT_EQ(ask("10 0064 0002 04 0051 1388"), "10 0064 0002");
  site_.send_values(0x0001, 0, 0);
  EXPECT_EQ(ask("16 0064 fff0 0003"), "16 0064 fff0 0003");
  site_.send_values(0x0000, 0, 0);
  EXPECT_EQ(ask("16 0064 fff0 0003"), "96 03");
}

TEST_F(MaskWrites, AMaskCarriesNoCommandFromBeforeAFault) {
  EXPECT_EQ(ask("10 0064 0002 04 0051 1388"), "10 0064 0002");
  site_.send_values(0x0008, 0, 0);
  EXPECT_EQ(ask("16 0064 fff0 0003"), "96 03");
}

TEST_F(MaskWrites, AMaskCarriesNoCommandFromDuringAFault) {
  site_.send_values(0x0008, 0, 0);
  EXPECT_EQ(ask("10 0064 0002 04 0051 1388"), "10 0064 0002");
  EXPECT_EQ(ask("16 0064 fff0 0003"), "16 0064 fff0 0003");
  for (int i = 0; i < 10; ++i) {
    site_.run_without_values(milliseconds(100));
    site_.send_values(0, 0, 0);
  }
  EXPECT_EQ(ask("16 0064 fff0 0003"), "96 03");
}

TEST_F(MaskWrites, AMaskCarriesNoCommandFromBeforeABoot) {
  EXPECT_EQ(ask("10 0064 0002 04 0051 1388"), "10 0064 0002");
  site_.bring_up();
  EXPECT_EQ(ask("16 0064 fff0 0003"), "96 03");
}

TEST_F(MaskWrites, AMaskBuildsOnNothingAfterACommandOfAnotherWriterOfUnknownOutcome) {
  EXPECT_EQ(ask("06 012c 1234"), "06 012c 1234");
  puppet().mute = true;
  const auto outcome = another_writes("acceleration");
  site_.loop().advance(milliseconds(900));
  ASSERT_TRUE(outcome.done());
  ASSERT_TRUE(outcome.get().error().outcome_unknown) << canopen::to_string(outcome.get().error());
  puppet().mute = false;
  EXPECT_EQ(ask("16 012c ff00 0008"), "96 03");
}

TEST_F(MaskWrites, AMaskIsRefusedWhereACommandBeforeItChangedItsBits) {
  EXPECT_EQ(ask("06 012c 1234"), "06 012c 1234");
  puppet().written.clear();
  puppet().mute = true;
  const auto other = another_writes("acceleration");
  site_.loop().advance(milliseconds(200));
  expect_waiting("16 012c ff00 0008");
  site_.loop().advance(milliseconds(650));
  ASSERT_TRUE(other.done());
  EXPECT_TRUE(other.get().error().outcome_unknown);
  EXPECT_EQ(site_.answer(site_.client()), "96 03");
  puppet().mute = false;
  site_.run(milliseconds(500));
  EXPECT_TRUE(puppet().written.empty());
}

TEST_F(MaskWrites, AMaskOfAReadableRegisterDoesNotBuildOnWhatACommandOfUnknownOutcomeMayHaveReplaced) {
  site_.run(milliseconds(1500));
  puppet().mute = true;
  const auto other = another_writes("ramp");
  site_.loop().advance(milliseconds(200));
  expect_waiting("16 0134 00ff 0100");
  site_.loop().advance(milliseconds(650));
  ASSERT_TRUE(other.done());
  EXPECT_TRUE(other.get().error().outcome_unknown);
  EXPECT_EQ(site_.answer(site_.client()), "96 0b") << "at once: what was read is not what the drive may hold now";
  EXPECT_TRUE(puppet().written.empty());
}

TEST_F(MaskWrites, AMaskOfTheControlCommandThatWaitsForTheSdoChannelDoesNotOutliveAStandstill) {
  site_.send_values(0x0001, 0, 0);
  EXPECT_EQ(ask("06 0064 0051"), "06 0064 0051");
  puppet().written.clear();
  puppet().mute = true;
  const auto reading = read_ramp();
  expect_waiting("16 0064 fff0 0003");
  site_.send_values(0x0000, 0, 0);
  EXPECT_EQ(site_.answer(site_.client()), "96 04") << "void, at once";
  puppet().mute = false;
  site_.run(milliseconds(500));
  EXPECT_TRUE(puppet().written.empty());
  EXPECT_TRUE(puppet().rpdos.empty());
  EXPECT_FALSE(reading.done() && reading.get().has_error());
}

TEST_F(MaskWrites, AMaskOfASetPointThatWaitsForTheSdoChannelOutlivesAStandstill) {
  site_.send_values(0x0001, 0, 0);
  EXPECT_EQ(ask("06 012c 1234"), "06 012c 1234");
  puppet().written.clear();
  puppet().mute = true;
  const auto reading = read_ramp();
  expect_waiting("16 012c ff00 0008");
  site_.send_values(0x0000, 0, 0);
  puppet().mute = false;
  site_.loop().advance(milliseconds(600));
  EXPECT_EQ(site_.answer(site_.client()), "16 012c ff00 0008");
  ASSERT_EQ(puppet().written.size(), 1U);
  EXPECT_EQ(puppet().written[0].raw, 0x1208U);
}

TEST_F(MaskWrites, AMaskThatWaitsChangesTheWordThatStandsAtItsTurn) {
  EXPECT_EQ(ask("06 012c 1234"), "06 012c 1234");
  puppet().written.clear();
  puppet().mute = true;
  const auto reading = read_ramp();
  const auto other = another_writes("acceleration");
  expect_waiting("16 012c 00ff 0100");
  puppet().mute = false;
  site_.loop().advance(milliseconds(600));
  ASSERT_TRUE(other.done());
  EXPECT_TRUE(other.get().has_value());
  EXPECT_EQ(site_.answer(site_.client()), "16 012c 00ff 0100");
  ASSERT_EQ(puppet().written.size(), 2U);
  EXPECT_EQ(puppet().written[1].raw, 0x0101U);
}

TEST(MaskWritesToADriveWithQuickStop, AMaskCarriesNoCommandFromBeforeAQuickStop) {
  config::Model model = modbus_test::example_model();
  config::Drive& drive = model.drives.front();
  config::Signal quick_stop = drive.signals[*drive.faults.fault];
  quick_stop.name = "quick_stop_active";
  quick_stop.derived->mask = 0x0010;
  quick_stop.derived->values = {0x0010};
  quick_stop.modbus.address = 5;
  drive.faults.quick_stop = drive.signals.size();
  drive.signals.push_back(quick_stop);
  Site site(std::move(model));
  site.bring_up();
  site.send_values(0x0001, 0, 0);
  EXPECT_EQ(site.ask("10 0064 0002 04 0051 1388"), "10 0064 0002");
  site.send_values(0x0011, 0, 0);
  EXPECT_EQ(site.ask("16 0064 fff0 0003"), "96 03") << "the motor still runs, but it was stopped";
  EXPECT_EQ(site.ask("10 0064 0002 04 0052 1388"), "10 0064 0002");
  EXPECT_EQ(site.ask("16 0064 fff0 0003"), "16 0064 fff0 0003") << "what was commanded since then";
}

TEST_F(MaskWrites, AMaskOfAReadableRegisterBuildsOnTheNewestKnowledge) {
  site_.run(milliseconds(1500));
  EXPECT_EQ(ask("16 0134 00ff 0100"), "16 0134 00ff 0100");  // the drive said 7
  ASSERT_EQ(puppet().written.size(), 1U);
  EXPECT_EQ(puppet().written[0].raw, 0x0107U);
  EXPECT_EQ(ask("16 0134 ff00 0008"), "16 0134 ff00 0008");  // before the next poll
  ASSERT_EQ(puppet().written.size(), 2U);
  EXPECT_EQ(puppet().written[1].raw, 0x0108U);
}

TEST(MaskWritesToAnAbsentDrive, AMaskOfAReadableRegisterHasNothingToBuildOn) {
  Site site;
  EXPECT_EQ(site.ask("16 0134 00ff 0100"), "96 0b");
}

}  // namespace
