#include <gmock/gmock.h>

#include <fstream>
#include <string>

#include "tests/unit/config/site.h"

namespace config {
namespace {

Loaded load_shipped(const std::string& name) {
  return load({.file = GATEWAY_SOURCE_DIR "/config/" + name, .profile_dirs = {kProfiles}, .host_name = "host"});
}

/// A line of words begins with "# "; a key that is switched off with "#" alone.
std::string with_all_keys(const std::string& name) {
  std::ifstream in(GATEWAY_SOURCE_DIR "/config/" + name);
  std::string text;
  for (std::string line; std::getline(in, line);) {
    text += (line.starts_with('#') && !line.starts_with("# ") ? line.substr(1) : line) + '\n';
  }
  return text;
}

TEST(TheExample, WatchesAndLetsNobodyCommand) {
  const Loaded loaded = load_shipped("gateway.example.toml");
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  ASSERT_EQ(loaded.model->drives.size(), 1U);
  EXPECT_EQ(loaded.model->drives[0].commands.writers, Writers());
  EXPECT_EQ(loaded.model->modbus->write_from, Modbus().write_from);
  EXPECT_FALSE(loaded.model->modbus->read_from.empty());
}

TEST(TheExample, IsAcceptedWithEveryKeySwitchedOn) {
  const Loaded loaded = load_site(with_all_keys("gateway.example.toml"));
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  EXPECT_TRUE(loaded.model->mqtt && loaded.model->http);
  ASSERT_EQ(loaded.model->drives.size(), 1U);
  EXPECT_EQ(loaded.model->drives[0].commands.writers, (Writers{.local = true}));
  EXPECT_TRUE(canopen::first_stop(loaded.model->drives[0].node.motor).has_value());
  EXPECT_EQ(loaded.findings.size(), 2U) << "what is unconfirmed of a Veichi:\n" << lines(loaded.findings);
}

TEST(TheLongExample, IsAcceptedWithAllFourSystems) {
  const Loaded loaded = load_shipped("four-drives.example.toml");
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  EXPECT_EQ(loaded.model->drives.size(), 4U);
  EXPECT_TRUE(summary(*loaded.model).starts_with("ok: 1 bus, 4 drives, "));
}

TEST(TheDemo, RunsTheFourSystemsOnABusInsideTheProcess) {
  const Loaded loaded = load_shipped("demo.toml");
  ASSERT_TRUE(loaded.model.has_value()) << lines(loaded.findings);
  const Model& model = *loaded.model;
  EXPECT_EQ(model.gateway.name, "demo");
  EXPECT_EQ(model.buses.at(0).interface, kVirtualInterface);
  EXPECT_EQ(model.modbus->listen, (std::vector<Endpoint>{{"127.0.0.1", 1502}}));
  EXPECT_EQ(model.mqtt->brokers, (std::vector<Endpoint>{{"127.0.0.1", 1883}}));
  std::vector<std::string> profiles;
  for (const Drive& drive : model.drives) {
    profiles.push_back(drive.profile);
    EXPECT_EQ(drive.commands.writers, (Writers{.modbus = true, .mqtt = true, .local = true})) << drive.name;
    EXPECT_EQ(drive.commands.raw, drive.name == "pump1") << drive.name;  // its fault is raised by a raw write
    EXPECT_TRUE(canopen::first_stop(drive.node.motor).has_value()) << drive.name;
    for (const canopen::MappedObject& field : drive.node.rpdos.at(0).mapping) {
      EXPECT_NE(field.use, canopen::FieldUse::unnamed) << drive.name;
    }
    for (const Signal& signal : drive.signals) {
      const bool setpoint = writable(signal.access) && signal.name != "control_command";
      EXPECT_TRUE(!setpoint || signal.max.has_value()) << drive.name << " " << signal.name;
    }
  }
  EXPECT_THAT(profiles, testing::ElementsAre("veichi-ac300", "veichi-ac310", "invt-goodrive600", "vacon-opte6"));
}

}  // namespace
}  // namespace config
