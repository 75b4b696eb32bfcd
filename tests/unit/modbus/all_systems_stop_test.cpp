// One stop for all over Modbus, on simulated drives of every kind that run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <string>

#include "tests/unit/modbus/simulated_plant.h"

namespace {

using modbus_test::kWritten;
using modbus_test::SimulatedPlant;
using testing::HasSubstr;
using namespace std::chrono_literals;

constexpr std::uint8_t kFan = 3;
constexpr std::uint8_t kPump = 5;
constexpr std::uint8_t kHoist = 7;
constexpr std::uint8_t kMixer = 9;
constexpr std::uint8_t kPress = 11;
constexpr std::uint8_t kForward = 1;
constexpr std::array<std::uint16_t, 3> kStartWords{6, 7, 15};

std::string drive(const std::string& name, int node, const std::string& profile, const std::string& more) {
  return "[[drive]]\nname = \"" + name + "\"\nnode = " + std::to_string(node) + "\nprofile = \"" + profile + "\"\n" +
         more + "[drive.commands]\nwriters = [\"modbus\"]\n";
}

std::string site(const std::string& presets_of_fan) {
  return drive("fan1", kFan, "veichi-ac300", presets_of_fan) +
         drive("pump1", kPump, "veichi-ac310", "presets = [\"veichi-command-codes\"]\n") +
         drive("hoist1", kHoist, "invt-goodrive600",
               "presets = [\"invt-command-codes\"]\n"
               "settings = { 1 = \"frequency_command\", 2 = \"unused\", 3 = \"unused\" }\n"
               "returns = { 1 = \"output_frequency\", 2 = \"set_frequency\", 3 = \"dc_bus_voltage\" }\n") +
         drive("mixer1", kMixer, "vacon-opte6", "") + drive("press1", kPress, "cia402-velocity", "");
}

void run_all(SimulatedPlant& plant) {
  for (const std::uint8_t unit : {kFan, kPump, kHoist}) {
    ASSERT_EQ(plant.command(unit, kForward, 2000, 0, 0), kWritten) << plant.failure(unit == kFan ? "fan1" : "pump1");
  }
  for (const std::uint8_t unit : {kMixer, kPress}) {
    for (const std::uint16_t word : kStartWords) {
      ASSERT_EQ(plant.command(unit, word, 0, 0, 600), kWritten) << plant.failure("mixer1");
    }
  }
  plant.run(5s);
  for (const std::uint8_t unit : {kFan, kPump, kHoist, kMixer, kPress}) {
    ASSERT_TRUE(plant.turns(unit)) << "node " << int{unit};
  }
}

TEST(AllSystems, OneRegisterStopsThemAll) {
  SimulatedPlant plant(site("presets = [\"veichi-command-codes\"]\n"));
  run_all(plant);
  EXPECT_EQ(plant.ask(0, "06 0014 0001"), "0600140001");
  plant.run(30s);
  for (const std::uint8_t unit : {kFan, kPump, kHoist, kMixer, kPress}) {
    EXPECT_FALSE(plant.turns(unit)) << "node " << int{unit};
  }
}

TEST(AllSystems, OneWithoutAStopValueIsNamedAndHoldsNobodyBack) {
  SimulatedPlant plant(site(""));
  run_all(plant);
  EXPECT_EQ(plant.ask(0, "06 0014 0001"), "860b");
  EXPECT_THAT(plant.failure("fan1"), HasSubstr("stop"));
  plant.run(30s);
  EXPECT_TRUE(plant.turns(kFan));
  for (const std::uint8_t unit : {kPump, kHoist, kMixer, kPress}) {
    EXPECT_FALSE(plant.turns(unit)) << "node " << int{unit};
  }
}

}  // namespace
