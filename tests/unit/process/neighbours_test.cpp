// Who and what else is on the bus, and drives that lack what others have: what the plant makes of it.

#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>

#include "tests/unit/process/simulated_bus.h"

namespace process {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kNeighbour = 5;

std::string site_with(const std::string& profile, const std::string& keys = "") {
  return "[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"" + profile + "\"\n" + keys +
         "[drive.commands]\nwriters = [\"modbus\"]\n";
}

class NeighboursTest : public SimulatedBus {
 protected:
  void bring_online(const std::string& site, const std::string& bus = "") {
    load(site, bus);
    add("cia402-velocity", kNeighbour).power_on();
    start();
    ASSERT_TRUE(wait_online()) << status().boot_text;
    run(3s);
    ASSERT_FALSE(bus_alarm().active) << bus_alarm().text;
  }
};

TEST_F(NeighboursTest, APlcWithOurNodeIdIsAnAlarmUntilAMinuteAfterItsLastHeartbeat) {
  bring_online(site_with("cia402-velocity"), "other_master = true\n");
  neighbour_.send(0x700U + kGateway, {0x05});
  run(500ms);
  EXPECT_TRUE(bus_alarm().active);
  EXPECT_EQ(bus_alarm().reason, "own-node-id");
  EXPECT_EQ(bus_alarm().severity, config::Severity::fault);
  EXPECT_TRUE(status().online);
  loop_.advance(61s, 5ms);
  EXPECT_FALSE(bus_alarm().active) << bus_alarm().text;
}

/// What a PLC that takes the same drive for its own sends, and how it is told.
struct Command {
  std::string name;
  std::function<void(Neighbour&)> send;
  std::string told;
};

std::ostream& operator<<(std::ostream& out, const Command& command) {
  return out << command.name;
}

class OtherMasterTest : public NeighboursTest, public testing::WithParamInterface<Command> {};

TEST_P(OtherMasterTest, IsAnAlarmAndDisturbsNothing) {
  bring_online(site_with("cia402-velocity"));
  for (int i = 0; i < 20; ++i) {
    GetParam().send(neighbour_);
    run(100ms);
  }
  EXPECT_TRUE(bus_alarm().active);
  EXPECT_EQ(bus_alarm().reason, "second-master");
  EXPECT_EQ(bus_alarm().severity, config::Severity::warning);
  EXPECT_EQ(bus_alarm().text, "another master or a tool is on the bus: it sends " + GetParam().told);
  EXPECT_EQ(bus_alarm().count, 1U);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_EQ(status().doubled, canopen::Doubled::no) << status().doubled_text;
  loop_.advance(62s, 5ms);
  EXPECT_FALSE(bus_alarm().active) << bus_alarm().text;
}

TEST_P(OtherMasterTest, IsARemarkWhereItIsWanted) {
  bring_online(site_with("cia402-velocity"), "other_master = true\n");
  for (int i = 0; i < 20; ++i) {
    GetParam().send(neighbour_);
    run(100ms);
  }
  EXPECT_FALSE(bus_alarm().active) << bus_alarm().text;
  EXPECT_EQ(bus_remarks_.size(), 1U);
  EXPECT_TRUE(status().online) << status().boot_text;
}

INSTANTIATE_TEST_SUITE_P(
    Signs, OtherMasterTest,
    testing::Values(Command{"NmtStartToAll", [](Neighbour& plc) { plc.send(0x000, {0x01, 0x00}); },
                            "NMT commands (start to all nodes)"},
                    Command{"NmtStart", [](Neighbour& plc) { plc.send(0x000, {0x01, 0x05}); },
                            "NMT commands (start to node 5)"},
                    Command{"SdoRead", [](Neighbour& plc) { plc.send(0x605, {0x40, 0x43, 0x60, 0x00, 0, 0, 0, 0}); },
                            "SDO requests (to node 5)"},
                    Command{"Rpdo", [](Neighbour& plc) { plc.send(0x205, {0x06, 0x00, 0x00, 0x00}); },
                            "RPDOs (to node 5), unless a TPDO of another drive has that identifier"}),
    [](const auto& parameter) { return parameter.param.name; });

TEST_F(NeighboursTest, ADriveThatAPlcStopsIsToldAndNotStartedAgain) {
  bring_online(site_with("cia402-velocity"));
  neighbour_.send(0x000, {0x02, kNeighbour});
  run(5s);
  EXPECT_EQ(status().nmt, canopen::NmtState::stopped);
  EXPECT_TRUE(drive().alarm(alarms::AlarmKind::boot).active);
  EXPECT_EQ(neighbour_.heard(0x000), 1U) << "the start of the boot";
}

// A master of before has left an entry for our node id in another place, by which the drive would trip.
TEST_F(NeighboursTest, AnEntryForOurNodeIdInAnotherPlaceOf1016IsUsed) {
  load(site_with("cia402-velocity", "supervise_gateway = \"2s\"\n"));
  simulator::Drive& simulated = add("cia402-velocity", kNeighbour);
  simulated.power_on();
  neighbour_.send(0x605, {0x23, 0x16, 0x10, 0x02, 0x64, 0x00, kGateway, 0x00});  // 100 ms
  run(100ms);
  start();
  ASSERT_TRUE(wait_online()) << status().boot_text;
  EXPECT_EQ(simulator::ObjectDictionary::read(*simulated.dictionary().find({0x1016, 1})), 0U);
  EXPECT_EQ(simulator::ObjectDictionary::read(*simulated.dictionary().find({0x1016, 2})), 0x007F07D0U);
  run(2s);
  const std::uint64_t before = simulated.record().emergencies;
  run(20s);
  EXPECT_EQ(simulated.record().emergencies, before);
  EXPECT_TRUE(status().online);
}

TEST_F(NeighboursTest, ADriveThatHasNeitherHeartbeatNorGuardingIsOnlineByItsTpdos) {
  load(site_with("invt-goodrive600", "heartbeat = \"0s\"\n"));
  simulator::Drive& simulated = add("invt-goodrive600", kNeighbour);
  simulated.misbehaviour().absent = {{0x1017, std::nullopt}, {0x100C, std::nullopt}, {0x100D, std::nullopt}};
  simulated.misbehaviour().heartbeat_stopped = true;
  simulated.power_on();
  start();
  ASSERT_TRUE(wait_online()) << status().boot_text;
  neighbour_.forget();
  for (int i = 0; i < 300; ++i) {
    run(100ms);
    ASSERT_TRUE(status().online);
  }
  EXPECT_EQ(neighbour_.heard(0x705), 0U) << "no request";
  simulated.misbehaviour().unplugged = true;
  run(2s);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(drive().alarm(alarms::AlarmKind::heartbeat).active);
}

}  // namespace
}  // namespace process
