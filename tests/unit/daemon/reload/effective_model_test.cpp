#include "daemon/reload/effective_model.h"

#include <gtest/gtest.h>

#include "config/difference.h"

namespace gateway {
namespace {

using Names = std::vector<std::string>;
using Waiting = std::vector<WaitingDrive>;

config::Bus bus(const std::string& name) {
  config::Bus made;
  made.name = name;
  made.interface = name;
  return made;
}

config::Drive drive(const std::string& name, std::size_t bus, std::uint8_t node) {
  config::Drive made;
  made.name = name;
  made.bus = bus;
  made.node.node = node;
  made.unit = node;
  return made;
}

/// Three drives on can0 and one on can1.
config::Model in_use() {
  config::Model made;
  made.buses = {bus("can0"), bus("can1")};
  made.drives = {drive("pump1", 0, 1), drive("pump2", 0, 2), drive("fan1", 0, 3), drive("mill", 1, 4)};
  made.modbus = config::Modbus{};
  return made;
}

Names names(const config::Model& model) {
  Names names;
  for (const config::Drive& drive : model.drives) {
    names.push_back(drive.name);
  }
  return names;
}

Names buses(const config::Model& model) {
  Names names;
  for (const config::Bus& bus : model.buses) {
    names.push_back(bus.name);
  }
  return names;
}

const config::Drive& find(const config::Model& model, const std::string& name) {
  return model.drives.at(config::find_named(model.drives, name).value());
}

/// Those of in_use() that turn, by name.
EffectiveModel effective(const config::Model& wanted, const Names& turn = {}) {
  std::vector<bool> turns;
  for (const std::string& name : names(in_use())) {
    turns.push_back(std::ranges::find(turn, name) != turn.end());
  }
  return effective_model(in_use(), wanted, turns);
}

TEST(EffectiveModelTest, WhereNothingTurnsItIsWhatIsWanted) {
  config::Model wanted = in_use();
  wanted.drives[0].unit = 77;
  wanted.drives.pop_back();
  wanted.buses.pop_back();
  wanted.buses[0].sync = std::chrono::milliseconds(10);
  wanted.modbus.reset();
  const EffectiveModel made = effective(wanted);
  EXPECT_EQ(made.model, wanted);
  EXPECT_EQ(made.waiting, Waiting{});
}

TEST(EffectiveModelTest, ADriveThatIsTheSameMayTurn) {
  config::Model wanted = in_use();
  wanted.drives[1].unit = 77;
  wanted.mqtt = config::Mqtt{};
  const EffectiveModel made = effective(wanted, {"pump1", "fan1", "mill"});
  EXPECT_EQ(made.model, wanted);
  EXPECT_TRUE(made.waiting.empty());
}

TEST(EffectiveModelTest, AChangedOneThatTurnsKeepsItsOldSection) {
  config::Model wanted = in_use();
  wanted.drives[0].on_stale = config::OnStale::zero;
  wanted.drives[1].on_stale = config::OnStale::zero;
  wanted.http = config::Http{};
  const EffectiveModel made = effective(wanted, {"pump1"});
  EXPECT_EQ(made.waiting, (Waiting{{.name = "pump1", .in_use = true, .turns = true}}));
  EXPECT_EQ(names(made.model), names(wanted));
  EXPECT_EQ(find(made.model, "pump1"), in_use().drives[0]);
  EXPECT_EQ(find(made.model, "pump2"), wanted.drives[1]);
  EXPECT_TRUE(made.model.http.has_value());
}

TEST(EffectiveModelTest, ARemovedOneThatTurnsStays) {
  config::Model wanted = in_use();
  wanted.drives.erase(wanted.drives.begin() + 1);
  const EffectiveModel made = effective(wanted, {"pump2"});
  EXPECT_EQ(made.waiting, (Waiting{{.name = "pump2", .in_use = true, .turns = true}}));
  EXPECT_EQ(names(made.model), (Names{"pump1", "fan1", "mill", "pump2"}));
}

TEST(EffectiveModelTest, ItsBusStaysWithAllThatIsOnIt) {
  config::Model wanted = in_use();
  wanted.buses[0].bitrate = 500'000;
  wanted.drives[2].on_stale = config::OnStale::zero;
  wanted.drives[3].on_stale = config::OnStale::zero;
  wanted.drives.push_back(drive("fan2", 0, 9));
  const EffectiveModel made = effective(wanted, {"pump1"});
  EXPECT_EQ(buses(made.model), (Names{"can0", "can1"})) << "the gateway's unit shows them by their places";
  EXPECT_EQ(made.model.buses[0], in_use().buses[0]);
  EXPECT_EQ(find(made.model, "fan1").on_stale, in_use().drives[2].on_stale) << "a drive is as its bus";
  EXPECT_EQ(find(made.model, "mill").on_stale, config::OnStale::zero) << "on another bus";
  EXPECT_FALSE(config::find_named(made.model.drives, "fan2"));
  EXPECT_EQ(made.waiting, (Waiting{{.name = "pump1", .in_use = true, .turns = true},
                                   {.name = "pump2", .in_use = true},
                                   {.name = "fan1", .in_use = true},
                                   {.name = "fan2"}}));
}

TEST(EffectiveModelTest, ARemovedBusStaysAsLongAsADriveOnItTurns) {
  config::Model wanted = in_use();
  wanted.buses.pop_back();
  wanted.drives.pop_back();
  const EffectiveModel made = effective(wanted, {"mill"});
  EXPECT_EQ(buses(made.model), (Names{"can0", "can1"}));
  EXPECT_EQ(find(made.model, "mill").bus, 1U);
  EXPECT_EQ(buses(effective(wanted).model), Names{"can0"});
}

TEST(EffectiveModelTest, ABusOfAnotherNameOnItsInterfaceWaits) {
  config::Model wanted = in_use();
  wanted.buses[1].name = "hall";
  const EffectiveModel made = effective(wanted, {"mill"});
  EXPECT_EQ(buses(made.model), (Names{"can0", "can1"}));
  EXPECT_EQ(made.model.buses[find(made.model, "mill").bus].name, "can1");
  EXPECT_EQ(made.waiting.size(), 1U);
  EXPECT_EQ(buses(effective(wanted).model), (Names{"can0", "hall"}));
}

TEST(EffectiveModelTest, ABusThatStaysHasThePlaceOfTheOneThatWaitsForIt) {
  config::Model wanted = in_use();
  wanted.buses[0].name = "hall";
  wanted.buses.push_back(bus("can2"));
  EXPECT_EQ(buses(effective(wanted, {"pump1"}).model), (Names{"can0", "can1", "can2"}));
  // A removed one is behind the others.
  wanted = in_use();
  wanted.buses.erase(wanted.buses.begin());
  wanted.drives = {drive("mill", 0, 4)};
  const EffectiveModel made = effective(wanted, {"pump1"});
  EXPECT_EQ(buses(made.model), (Names{"can1", "can0"}));
  EXPECT_EQ(find(made.model, "mill").bus, 0U);
  EXPECT_EQ(find(made.model, "pump1").bus, 1U);
}

// Two buses that changed their interfaces with each other.
TEST(EffectiveModelTest, EachBusThatStaysIsThereOnce) {
  config::Model wanted = in_use();
  std::swap(wanted.buses[0].interface, wanted.buses[1].interface);
  const EffectiveModel made = effective(wanted, {"pump1"});
  EXPECT_EQ(made.model.buses[0], in_use().buses[0]);
  EXPECT_EQ(std::ranges::count(buses(made.model), "can0"), 1);
  for (const config::Drive& drive : made.model.drives) {
    EXPECT_EQ(made.model.buses[drive.bus].name, drive.name == "mill" ? "can1" : "can0");
  }
}

TEST(EffectiveModelTest, WhoIsToHaveWhatItHasWaits) {
  config::Model wanted = in_use();
  wanted.drives[0].name = "pump9";  // Under another name: the old one goes, a new one comes, on the same node.
  EffectiveModel made = effective(wanted, {"pump1"});
  EXPECT_EQ(made.waiting, (Waiting{{.name = "pump9"}, {.name = "pump1", .in_use = true, .turns = true}}));
  EXPECT_EQ(names(made.model), (Names{"pump2", "fan1", "mill", "pump1"}));
  wanted.drives[0].node.node = 20;  // The Modbus unit is still the same.
  made = effective(wanted, {"pump1"});
  EXPECT_EQ(made.waiting.size(), 2U);
  wanted.drives[0].unit = 20;
  made = effective(wanted, {"pump1"});
  EXPECT_EQ(made.waiting.size(), 1U);
  EXPECT_EQ(names(made.model), (Names{"pump9", "pump2", "fan1", "mill", "pump1"}));
}

TEST(EffectiveModelTest, TheCobIdOfAPdoIsSuchAThingOnItsBusAlone) {
  config::Model wanted = in_use();
  wanted.drives[0].name = "pump9";
  wanted.drives[0].node.node = 20;
  wanted.drives[0].unit = 20;
  wanted.drives[0].node.tpdos.push_back({.number = 1, .cob_id = 0x181});
  config::Model old = in_use();
  old.drives[0].node.tpdos.push_back({.number = 1, .cob_id = 0x181});
  const std::vector<bool> turns{true, false, false, false};
  EXPECT_EQ(effective_model(old, wanted, turns).waiting.size(), 2U);
  wanted.drives[0].bus = 1;
  EXPECT_EQ(effective_model(old, wanted, turns).waiting.size(), 1U);
}

TEST(EffectiveModelTest, AStandingOneThatWouldTakeItsPlaceStaysAsItIs) {
  config::Model wanted = in_use();
  std::swap(wanted.drives[0].node.node, wanted.drives[1].node.node);
  const EffectiveModel made = effective(wanted, {"pump1"});
  EXPECT_EQ(made.waiting,
            (Waiting{{.name = "pump1", .in_use = true, .turns = true}, {.name = "pump2", .in_use = true}}));
  EXPECT_EQ(find(made.model, "pump2"), in_use().drives[1]);
}

TEST(EffectiveModelTest, ItsAddressesOnTheFlatUnitAreItsOwn) {
  config::Model old = in_use();
  old.modbus->flat_unit = 100;
  old.drives[0].flat = 0;
  config::Model wanted = old;
  wanted.drives[0].flat = 1000;
  wanted.drives[1].flat = 500;
  const EffectiveModel made = effective_model(old, wanted, {true, false, false, false});
  EXPECT_EQ(made.waiting.size(), 2U);
  EXPECT_EQ(find(made.model, "pump2").flat, std::nullopt);
}

TEST(EffectiveModelTest, AFlatUnitThatIsTheUnitOfOneThatStaysWaits) {
  config::Model wanted = in_use();
  wanted.drives.erase(wanted.drives.begin());
  wanted.modbus->flat_unit = 1;
  wanted.drives[0].flat = 0;
  const EffectiveModel made = effective(wanted, {"pump1"});
  EXPECT_EQ(made.model.modbus, in_use().modbus);
  EXPECT_EQ(find(made.model, "pump2").flat, std::nullopt) << "nothing would show it";
  EXPECT_EQ(effective(wanted).model, wanted);
}

TEST(EffectiveModelTest, WhenAllStandStillNothingIsLeftToDo) {
  config::Model wanted = in_use();
  wanted.drives[0].on_stale = config::OnStale::zero;
  wanted.drives[1].name = "pump8";
  wanted.buses[1].sync = std::chrono::milliseconds(20);
  const EffectiveModel first = effective(wanted, {"pump1", "pump2", "mill"});
  ASSERT_FALSE(first.waiting.empty());
  const EffectiveModel then = effective_model(first.model, wanted, std::vector<bool>(first.model.drives.size(), false));
  EXPECT_EQ(then.model, wanted);
  EXPECT_TRUE(then.waiting.empty());
}

}  // namespace
}  // namespace gateway
