#include "config/difference.h"

#include <gtest/gtest.h>

namespace config {
namespace {

using From = Positions;
constexpr std::optional<std::size_t> kNew = std::nullopt;

Bus bus(const std::string& name) {
  Bus made;
  made.name = name;
  made.interface = name;
  return made;
}

Drive drive(const std::string& name, std::size_t bus, std::uint8_t node) {
  Drive made;
  made.name = name;
  made.bus = bus;
  made.node.node = node;
  made.signals.resize(2);
  return made;
}

Model model() {
  Model made;
  made.gateway.name = "plant";
  made.buses = {bus("can0"), bus("can1")};
  made.drives = {drive("pump1", 0, 1), drive("pump2", 1, 2), drive("fan1", 0, 3)};
  made.modbus = Modbus{};
  return made;
}

TEST(DifferenceTest, TheSameIsNone) {
  const Difference same = difference(model(), model());
  EXPECT_EQ(same.drives, (From{0, 1, 2}));
  EXPECT_EQ(same.buses, (From{0, 1}));
  EXPECT_TRUE(is_none(same, model()));
}

TEST(DifferenceTest, AnotherOrderChangesNoDrive) {
  Model now = model();
  now.buses = {bus("can1"), bus("can0")};
  now.drives = {drive("fan1", 1, 3), drive("pump2", 0, 2), drive("pump1", 1, 1)};
  const Difference moved = difference(model(), now);
  EXPECT_EQ(moved.buses, (From{1, 0}));
  EXPECT_EQ(moved.drives, (From{2, 1, 0}));
  EXPECT_TRUE(is_none(moved, model()));
}

TEST(DifferenceTest, OneThatCameOrWent) {
  Model now = model();
  now.drives.erase(now.drives.begin());
  now.drives.push_back(drive("mill", 1, 4));
  const Difference other = difference(model(), now);
  EXPECT_EQ(other.drives, (From{1, 2, kNew}));
  EXPECT_FALSE(is_none(other, model()));
  Model fewer = model();
  fewer.drives.pop_back();
  EXPECT_FALSE(is_none(difference(model(), fewer), model()));
}

TEST(DifferenceTest, AnyValueOfADriveMakesItAnother) {
  Model now = model();
  now.drives[1].signals[1].unit = "Hz";
  EXPECT_EQ(difference(model(), now).drives, (From{0, kNew, 2}));
  now = model();
  now.drives[2].commands.writers.modbus = true;
  EXPECT_EQ(difference(model(), now).drives, (From{0, 1, kNew}));
}

TEST(DifferenceTest, ADriveOnAnotherBusIsAnother) {
  Model now = model();
  now.drives[0].bus = 1;
  EXPECT_EQ(difference(model(), now).drives, (From{kNew, 1, 2}));
}

TEST(DifferenceTest, DrivesOfAChangedBusAreOthers) {
  Model now = model();
  now.buses[0].bitrate = 250'000;
  const Difference other = difference(model(), now);
  EXPECT_EQ(other.buses, (From{kNew, 1}));
  EXPECT_EQ(other.drives, (From{kNew, 1, kNew}));
}

TEST(DifferenceTest, ANameIsWhatABusIsKnownBy) {
  Model now = model();
  now.buses[0].name = "hall";
  const Difference other = difference(model(), now);
  EXPECT_EQ(other.buses, (From{kNew, 1}));
  EXPECT_EQ(other.drives, (From{kNew, 1, kNew}));
}

TEST(DifferenceTest, SectionsEachForItself) {
  Model now = model();
  now.modbus->max_clients = 5;
  EXPECT_TRUE(difference(model(), now).modbus);
  EXPECT_FALSE(is_none(difference(model(), now), model()));
  now = model();
  now.mqtt = Mqtt{};
  now.http = Http{};
  now.recorder = Recorder{};
  const Difference came = difference(model(), now);
  EXPECT_TRUE(came.mqtt && came.http && came.recorder);
  EXPECT_FALSE(came.modbus);
  EXPECT_EQ(came.drives, (From{0, 1, 2}));
  EXPECT_TRUE(difference(now, model()).http) << "it went";
}

TEST(DifferenceTest, NamesTheKeysOfTheGateway) {
  Model now = model();
  EXPECT_TRUE(difference(model(), now).gateway.empty());
  now.gateway = {.name = "other", .state_dir = "/srv", .control = "", .journal = 1};
  EXPECT_EQ(difference(model(), now).gateway, (std::vector<std::string>{"name", "state_dir", "control", "journal"}));
  now.gateway.name = "plant";
  EXPECT_EQ(difference(model(), now).gateway.front(), "state_dir");
  EXPECT_FALSE(is_none(difference(model(), now), model()));
}

}  // namespace
}  // namespace config
