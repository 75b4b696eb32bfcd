#include <gmock/gmock.h>

#include "tests/unit/config/site.h"

namespace config {
namespace {

using testing::HasSubstr;

const std::string kOwn = R"(title = "a drive of the test"
[signals.output_frequency]
object = "0x2000:01"
type = "u16"
)";

std::string site(std::string_view more, std::string_view unit = "") {
  return own_site(std::string(unit) + std::string(more));
}

std::string signal(std::string_view name, std::string_view type, std::string_view keys) {
  return "[drive.signals." + std::string(name) + "]\nobject = \"0x2100:01\"\ntype = \"" + std::string(type) + "\"\n" +
         std::string(keys) + "\n";
}

std::string error_with(std::string_view more) {
  return error_of(site(more), kOwn);
}

ModbusPlace place_of_x(std::string_view type, std::string_view keys) {
  return signal_of(model_of(site(signal("x", type, keys)), kOwn).drives.at(0), "x").modbus;
}

TEST(Addresses, OfFixedNamesNeedNotBeGiven) {
  const Drive drive = model_of(site(signal("running", "bool", "")), kOwn).drives.at(0);
  EXPECT_EQ(signal_of(drive, "output_frequency").modbus, (ModbusPlace{ModbusKind::holding, 2, 1, false}));
  EXPECT_EQ(signal_of(drive, "running").modbus, (ModbusPlace{ModbusKind::bit, 0, 1, false}));
}

TEST(Addresses, TakeAsManyRegistersAsTheValueNeeds) {
  EXPECT_EQ(place_of_x("u8", "address = 200"), (ModbusPlace{ModbusKind::holding, 200, 1, false}));
  EXPECT_EQ(place_of_x("i32", "address = 200"), (ModbusPlace{ModbusKind::holding, 200, 2, false}));
  EXPECT_EQ(place_of_x("f32", "address = 1100"), (ModbusPlace{ModbusKind::holding, 1100, 2, false}));
  EXPECT_EQ(place_of_x("u64", "address = 65532"), (ModbusPlace{ModbusKind::holding, 65532, 4, false}));
  EXPECT_EQ(place_of_x("u16", "address = 200\nas = \"float\""), (ModbusPlace{ModbusKind::holding, 200, 2, true}));
  EXPECT_EQ(place_of_x("bool", "address = 200"), (ModbusPlace{ModbusKind::bit, 200, 1, false}));
}

TEST(Addresses, MustBeGivenForOtherNamesAndTheErrorNamesAFreeOne) {
  EXPECT_EQ(error_with(signal("x", "u16", "")),
            "gateway.toml:7:16: error: drive \"a\": signal \"x\" needs an address for Modbus; 200 is free");
  EXPECT_THAT(error_with(signal("y", "u16", "address = 200") + signal("x", "u32", "")), HasSubstr("202 is free"));
  EXPECT_TRUE(load_site(site(signal("x", "u16", ""), "unit = \"none\"\n"), kOwn).model.has_value());
}

TEST(Addresses, BelowTwoHundredHaveTheirMeaning) {
  EXPECT_THAT(error_with(signal("x", "u16", "address = 5")), HasSubstr("0..199 have the same meaning for every drive"));
  EXPECT_THAT(error_with(signal("x", "u16", "address = 199")), HasSubstr("cannot have Modbus address 199"));
  EXPECT_THAT(error_with("[drive.signals.output_frequency]\naddress = 3\n"), HasSubstr("cannot have Modbus address 3"));
  EXPECT_THAT(error_with("[drive.signals.output_frequency]\nas = \"float\"\n"),
              HasSubstr("cannot stay at its fixed Modbus address 2; give it an even address from 200 on"));
  EXPECT_TRUE(
      load_site(site("[drive.signals.output_frequency]\nas = \"float\"\naddress = 200\n"), kOwn).model.has_value());
}

TEST(Addresses, StayOutOfTheDiagnostics) {
  EXPECT_THAT(error_with(signal("x", "u16", "address = 1000")), HasSubstr("1000..1099 are the diagnostics"));
  EXPECT_THAT(error_with(signal("x", "u16", "address = 1099")), HasSubstr("1000..1099 are the diagnostics"));
  EXPECT_THAT(error_with(signal("x", "u64", "address = 998")), HasSubstr("1000..1099 are the diagnostics"));
  EXPECT_TRUE(load_site(site(signal("x", "u16", "address = 999")), kOwn).model.has_value());
  EXPECT_TRUE(load_site(site(signal("x", "u16", "address = 1100")), kOwn).model.has_value());
}

TEST(Addresses, OfWideValuesAreEven) {
  EXPECT_THAT(error_with(signal("x", "u32", "address = 201")), HasSubstr("needs an even address, not 201"));
  EXPECT_THAT(error_with(signal("x", "u64", "address = 65534")), HasSubstr("reaches beyond Modbus address 65535"));
  EXPECT_THAT(error_with(signal("x", "u16", "address = 65536")), HasSubstr("out of range 0..65535"));
}

TEST(Addresses, DoNotOverlap) {
  EXPECT_THAT(error_with(signal("x", "u32", "address = 200") + signal("y", "u16", "address = 201")),
              HasSubstr("signal \"y\" overlaps \"x\" at Modbus address 200; 202 is free"));
  EXPECT_TRUE(load_site(site(signal("x", "u16", "address = 200") + signal("y", "bool", "address = 200")), kOwn)
                  .model.has_value());
}

TEST(Addresses, OfBooleansAreBits) {
  EXPECT_THAT(error_with(signal("x", "bool", "address = 200\nas = \"float\"")), HasSubstr("takes no as = \"float\""));
}

}  // namespace
}  // namespace config
