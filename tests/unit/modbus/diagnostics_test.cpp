#include <gtest/gtest.h>

#include <array>
#include <chrono>

#include "bridges/modbus/gateway_unit.h"
#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::kAccelerationObject;
using modbus_test::Site;
using std::chrono::milliseconds;

TEST(Diagnostics, OfADriveThatRuns) {
  Site site;
  site.bring_up();
  site.run(milliseconds(1500));  // the polled value too
  EXPECT_EQ(site.ask("03 03e8 0003"), "03 06 0033 0005 0000");
  EXPECT_EQ(site.ask("03 03f2 0001"), "03 02 0001");  // one boot-up
  EXPECT_EQ(site.ask("03 03fc 0001"), "03 02 0000");  // no NMT command yet
  // Fresh: 0 status_word, 2 output_frequency, 10 temperature. Commands are nothing that ages.
  EXPECT_EQ(site.ask("03 0410 000d"), "03 1a 0405 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000");
  site.run_without_values(milliseconds(400));
  EXPECT_EQ(site.ask("03 0410 0001"), "03 02 0400");
}

TEST(Diagnostics, AgesAreThoseOfTheMoment) {
  Site site;
  EXPECT_EQ(site.ask("03 03f0 0002"), "03 04 ffff ffff");
  site.bring_up();
  site.run(milliseconds(1500));
  site.puppet().heartbeat();
  site.settle();
  site.loop().advance(milliseconds(123));
  EXPECT_EQ(site.ask("03 03f0 0001"), "03 02 007b");
}

TEST(Diagnostics, TheAgeOfTheOldestValueIsThatOfTheOldestSource) {
  Site site;
  site.bring_up();
  site.run(milliseconds(1500));
  site.loop().advance(milliseconds(200));
  // TPDO2 came once, when the drive came up.
  const std::string answer = site.ask("03 03f1 0001");
  ASSERT_EQ(answer.size(), 10U) << answer;
  const unsigned long age = std::stoul(answer.substr(6), nullptr, 16);
  EXPECT_GE(age, 1700U);
  EXPECT_LE(age, 1800U);
}

TEST(Diagnostics, OfAnEmergency) {
  Site site;
  site.bring_up();
  site.puppet().emergency(std::array<std::uint8_t, 8>{0x10, 0x23, 0x03, 0x11, 0x22, 0x33, 0x44, 0x55});
  site.settle();
  // 1003 code, 1004 error register, 1005..1007 vendor bytes.
  EXPECT_EQ(site.ask("03 03eb 0005"), "03 0a 2310 0003 1122 3344 5500");
  EXPECT_EQ(site.ask("03 03f3 0001"), "03 02 0001");
  EXPECT_EQ(site.ask("03 03f7 0001"), "03 02 0001");
  const std::string state = site.ask("03 03e8 0001");
  EXPECT_EQ(std::stoul(state.substr(6), nullptr, 16) & 0x4U, 0x4U) << state;
}

TEST(Diagnostics, OfALostDrive) {
  Site site;
  site.bring_up();
  site.puppet().mute = true;
  site.loop().advance(milliseconds(2000), milliseconds(10));
  EXPECT_EQ(site.ask("03 03e9 0001"), "03 02 00ff");
  EXPECT_EQ(site.ask("03 03f6 0001"), "03 02 0001");  // one heartbeat loss
  const std::string state = site.ask("03 03e8 0001");
  EXPECT_EQ(std::stoul(state.substr(6), nullptr, 16) & 0x13U, 0U) << state;
  EXPECT_EQ(site.ask("03 0000 0001"), "83 0b");
}

TEST(Diagnostics, TheLastAbortFollowsTheWordOrder) {
  for (const auto order : {config::WordOrder::big, config::WordOrder::little}) {
    config::Model model = example_model();
    model.modbus->word_order = order;
    Site site(model);
    site.bring_up();
    site.puppet().refuse_writes[kAccelerationObject] = 0x06090030;
    EXPECT_EQ(site.ask("06 012c 0001"), "86 04");
    EXPECT_EQ(site.ask("03 03f4 0002"), order == config::WordOrder::big ? "03 04 0609 0030" : "03 04 0030 0609");
  }
}

TEST(Diagnostics, OnlyWhatACommandWasRefusedWithIsItsAbort) {
  Site site;
  site.bring_up();
  site.puppet().dictionary.erase(modbus_test::kRampObject);  // 0x06020000
  site.run(milliseconds(1500));
  EXPECT_EQ(site.ask("03 03f4 0002"), "03 04 0000 0000") << "a poll is no command";
}

TEST(Diagnostics, TellHowFarAWriteCameThatFailed) {
  Site site;
  site.bring_up();
  site.puppet().refuse_writes[modbus_test::kValveObject] = 0x08000022;
  EXPECT_EQ(site.ask("03 03f9 0001"), "03 02 0000");
  EXPECT_EQ(site.ask("0f 000a 0002 01 03"), "8f 04");
  EXPECT_EQ(site.ask("03 03f9 0001"), "03 02 0001");
  EXPECT_EQ(site.ask("05 000a ff00"), "05 000a ff00");
  EXPECT_EQ(site.ask("03 03f9 0001"), "03 02 0001") << "of the last that failed";
}

TEST(Diagnostics, SayWhatAnNmtCommandMadeOfItBeforeItsHeartbeatDoes) {
  config::Model model = modbus_test::example_model();
  model.drives[0].commands.nmt_while_running = true;  // Its values are not fresh after the first one.
  for (const auto& [command, state] : {std::pair("0002", "0004"), std::pair("0080", "007f")}) {
    Site site{model};
    site.bring_up();
    site.puppet().mute = true;  // Its heartbeat says nothing yet.
    EXPECT_EQ(site.ask("03 03e9 0001"), "03 02 0005");
    EXPECT_EQ(site.ask(std::string("06 03fc ") + command), std::string("06 03fc ") + command);
    EXPECT_EQ(site.ask("03 03e9 0001"), std::string("03 02 ") + state);
    EXPECT_EQ(std::stoul(site.ask("03 03e8 0001").substr(6), nullptr, 16) & 0x0002U, 0U);
    EXPECT_EQ(site.ask(site.client(), 0, "03 006e 0001"), "03 02 0000");  // of the bus' operational nodes
    // A start takes that back; what it said last counts, as for commands.
    EXPECT_EQ(site.ask("06 03fc 0001"), "06 03fc 0001");
    EXPECT_EQ(site.ask("03 03e9 0001"), "03 02 0005");
    EXPECT_EQ(site.ask(std::string("06 03fc ") + command), std::string("06 03fc ") + command);
    EXPECT_EQ(site.ask("03 03e9 0001"), std::string("03 02 ") + state);
    // And what it says itself is the same.
    site.puppet().mute = false;
    site.run_without_values(milliseconds(100));
    EXPECT_EQ(site.ask("03 03e9 0001"), std::string("03 02 ") + state);
    EXPECT_EQ(site.ask("06 03fc 0001"), "06 03fc 0001");
    site.run_without_values(milliseconds(100));
    EXPECT_EQ(site.ask("03 03e9 0001"), "03 02 0005");
  }
}

TEST(Diagnostics, ADriveThatDoesNotFollowAnNmtCommandIsShownAsItIs) {
  Site site;
  site.bring_up();
  site.puppet().deaf_to_nmt = true;
  EXPECT_EQ(site.ask("06 03fc 0002"), "06 03fc 0002");
  EXPECT_EQ(site.ask("03 03e9 0001"), "03 02 0004");
  site.run(std::chrono::seconds(3));
  EXPECT_EQ(site.ask("03 03e9 0001"), "03 02 0005");
}

TEST(Diagnostics, ACommandRegisterIsFreshWhileItsValueCounts) {
  Site site;
  site.bring_up();
  const auto of_100_on = [&site] { return site.ask("03 0416 0001"); };
  EXPECT_EQ(of_100_on(), "03 02 0000");
  EXPECT_EQ(site.ask("10 0064 0002 04 0003 1388"), "10 0064 0002");
  EXPECT_EQ(of_100_on(), "03 02 0030");  // 100 and 101: bits 4 and 5 of 1046
  site.send_values(0x0001, 0, 0);        // running
  site.send_values(0x0000, 0, 0);        // and stopped again
  EXPECT_EQ(of_100_on(), "03 02 0020") << "the run command is forgotten, the set-point is not";
}

TEST(Diagnostics, ShowWhoIsInControl) {
  config::Model model = example_model();
  model.drives[0].commands.lease = std::chrono::seconds(1);
  model.drives[0].commands.timeout = milliseconds(500);
  Site site(model);
  site.bring_up();
  const auto bits = [&site] { return std::stoul(site.ask("03 03e8 0001").substr(6), nullptr, 16) & 0xC0U; };
  EXPECT_EQ(bits(), 0U);
  EXPECT_EQ(site.ask("10 0064 0002 04 0003 1388"), "10 0064 0002");
  EXPECT_EQ(bits(), 0x80U) << "lease held";
  // Whatever this client asks is a sign of life.
  for (int i = 0; i < 4; ++i) {
    site.run(milliseconds(300));
    EXPECT_EQ(bits() & 0x40U, 0U);
  }
  EXPECT_EQ(bits(), 0U) << "but no accepted command, which a lease needs";
  site.run(milliseconds(600));
  EXPECT_EQ(bits(), 0x40U) << "the command timeout acted";
}

TEST(Diagnostics, AreReadOnlyButForTheNmtCommand) {
  Site site;
  site.bring_up();
  EXPECT_EQ(site.ask("06 03e8 0001"), "86 02");
  EXPECT_EQ(site.ask("06 0410 0001"), "86 02");
  EXPECT_EQ(site.ask("06 044b 0001"), "86 02");
  EXPECT_EQ(site.ask("10 03fc 0002 04 0001 0000"), "90 02");
}

class GatewayUnit : public testing::TestWithParam<std::uint8_t> {};

TEST_P(GatewayUnit, CountsAndKnowsItsParts) {
  Site site;
  const auto ask = [&site](std::string_view pdu) { return site.ask(site.client(), GetParam(), pdu); };
  EXPECT_EQ(ask("03 0001 0005"), "03 0a 0001 0000 0000 0000 0001");
  site.server().set_mqtt_connected(true);
  site.bring_up();
  EXPECT_EQ(ask("04 0001 0005"), "04 0a 0001 0001 0000 0001 0001");
  site.puppet().emergency(std::array<std::uint8_t, 8>{0x10, 0x23, 0x03});
  site.settle();
  EXPECT_EQ(ask("03 0003 0001"), "03 02 0001");
}

TEST_P(GatewayUnit, TheCounterGrowsEvery100Milliseconds) {
  config::Model model = example_model();
  model.modbus->idle_timeout = {};
  Site site(model);
  const auto ask = [&site] { return site.ask(site.client(), GetParam(), "03 0000 0001"); };
  EXPECT_EQ(ask(), "03 02 0000");
  site.loop().advance(milliseconds(99));
  EXPECT_EQ(ask(), "03 02 0000");
  site.loop().advance(milliseconds(1));
  EXPECT_EQ(ask(), "03 02 0001");
  site.loop().advance(std::chrono::hours(2), milliseconds(1000));
  EXPECT_EQ(ask(), "03 02 1941");  // 72001 wraps at 65536
}

TEST_P(GatewayUnit, ShowsTheBus) {
  Site site;
  site.bring_up();
  const auto ask = [&site](std::string_view pdu) { return site.ask(site.client(), GetParam(), pdu); };
  EXPECT_EQ(ask("03 0064 0001"), "03 02 0000");                                     // error-active
  EXPECT_EQ(ask("03 006e 0008"), "03 10 0020 0000 0000 0000 0000 0000 0000 0000");  // node 5 operational
  EXPECT_NE(ask("03 006a 0002"), "03 04 0000 0000");                                // frames received
  EXPECT_NE(ask("03 006c 0002"), "03 04 0000 0000");                                // frames sent
  site.plant().set_bus_state(0, {canopen::BusCondition::passive, 130, 12});
  EXPECT_EQ(ask("03 0064 0001"), "03 02 0002");
  EXPECT_EQ(ask("03 0066 0002"), "03 04 0082 000c");
}

TEST_P(GatewayUnit, UnusedReadsZeroAndNothingTakesAValue) {
  Site site;
  const auto ask = [&site](std::string_view pdu) { return site.ask(site.client(), GetParam(), pdu); };
  EXPECT_EQ(ask("03 0006 0002"), "03 04 0000 0000");
  EXPECT_EQ(ask("03 00c7 0001"), "03 02 0000");
  EXPECT_EQ(ask("03 00c8 0001"), "83 02");
  EXPECT_EQ(ask("03 03e8 0001"), "03 02 0000");
  EXPECT_EQ(ask("03 044c 0001"), "83 02");
  EXPECT_EQ(ask("01 0000 00c8"), "01 19 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 0000 00");
  EXPECT_EQ(ask("01 0001 00c8"), "81 02");
  EXPECT_EQ(ask("06 0000 0001"), "86 02");
  EXPECT_EQ(ask("05 0000 ff00"), "85 02");
  EXPECT_EQ(ask("06 03fc 0001"), "86 02");
}

INSTANTIATE_TEST_SUITE_P(BothUnits, GatewayUnit, testing::Values(std::uint8_t{0}, std::uint8_t{255}));

TEST(GatewayUnitBuses, MoreThanFiveBusesGoBeyondTheCommonBlock) {
  config::Model model = example_model();
  for (int i = 1; i < 7; ++i) {
    model.buses.push_back(model.buses[0]);
  }
  support::HandDrivenLoop loop;
  canopen::VirtualBus can(loop.executor());
  canopen::Bus bus(loop.executor(), can.connect(), {});
  std::vector<process::Plant::BusPort> ports(7, {&bus, [&bus] { return bus.statistics(); }});
  process::Plant plant(loop.executor(), model, ports);
  const modbus::GatewayUnit unit(plant, config::WordOrder::big);
  plant.set_bus_state(6, {canopen::BusCondition::warning, 1, 2});
  std::array<std::uint16_t, 20> out{};
  EXPECT_EQ(unit.read_registers({.address = 220, .quantity = 20}, canopen::Clock::now(), out), std::nullopt);
  EXPECT_EQ(out[0], 1);
  EXPECT_EQ(out[2], 1);
  EXPECT_EQ(out[3], 2);
  EXPECT_EQ(unit.read_registers({.address = 240, .quantity = 1}, canopen::Clock::now(), out),
            modbus::Exception::illegal_address);
}

}  // namespace
