// Function 43 before the simulated drives of the shipped profiles: objects that take more than one SDO frame.
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/modbus/simulated_plant.h"

namespace modbus_test {
namespace {

constexpr const char* kDrives = R"(
[[drive]]
name = "mixer1"
node = 7
profile = "cia402-velocity"
[[drive]]
name = "pump1"
node = 5
profile = "veichi-ac310"
)";

std::string text_of(const std::string& digits) {
  std::string text;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    text += static_cast<char>(std::stoul(digits.substr(i, 2), nullptr, 16));
  }
  return text;
}

TEST(ObjectsOfDrives, ATextIsReadWholeAndInParts) {
  SimulatedPlant plant(kDrives);
  const std::string head = "2b0d000007100800";
  const std::string whole = plant.ask(7, "2b 0d 00 00 07 1008 00 0000 0000");
  ASSERT_EQ(whole.substr(0, 20), head + "0000");
  const std::string name = text_of(whole.substr(24));
  EXPECT_EQ(whole.substr(20, 4),
            std::string("00") + "0123456789abcdef"[name.size() / 16] + "0123456789abcdef"[name.size() % 16]);
  EXPECT_GT(name.size(), 7U) << name << ": more than one segment";
  EXPECT_EQ(text_of(plant.ask(7, "2b 0d 00 00 07 1008 00 0003 0004").substr(24)), name.substr(3, 4));
  EXPECT_EQ(plant.ask(255, "2b 0d 00 00 07 1008 00 0000 0000"), whole);
}

TEST(ObjectsOfDrives, TheSerialNumberIsThatOfTheDrive) {
  SimulatedPlant plant(kDrives);
  const std::string object = plant.ask(7, "2b 0d 00 00 07 1018 04 0000 0000");
  ASSERT_EQ(object.substr(20, 4), "0004");
  const std::string bytes = text_of(object.substr(24));
  std::uint32_t number = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) {
    number = number << 8U | static_cast<std::uint8_t>(bytes[i]);
  }
  EXPECT_EQ(text_of(plant.ask(7, "2b 0e 04 82").substr(18)), std::to_string(number));
}

TEST(ObjectsOfDrives, AnAbortOfTheDriveIsToldByEveryUnit) {
  SimulatedPlant plant(kDrives);
  EXPECT_EQ(plant.ask(5, "2b 0d 00 00 05 5fff 00 0000 0000").substr(0, 12), "abff00060dec");
  EXPECT_EQ(plant.ask(0, "2b 0d 00 00 05 5fff 00 0000 0000").substr(0, 12), "abff00060dec");
  EXPECT_EQ(plant.ask(7, "2b 0d 00 00 05 5fff 00 0000 0000"), "ab02");
}

}  // namespace
}  // namespace modbus_test
