#include "bridges/modbus/process_table.h"

#include <gtest/gtest.h>

namespace {

using canopen::DataType;
using config::ModbusKind;
using modbus::kNoSignal;
using modbus::ProcessTable;

config::Signal signal(DataType type, ModbusKind kind, std::uint16_t address, std::uint16_t count = 1) {
  config::Signal made;
  made.type = type;
  made.modbus = {.kind = kind, .address = address, .count = count};
  return made;
}

config::Drive drive() {
  config::Drive made;
  made.signals = {signal(DataType::u16, ModbusKind::holding, 2), signal(DataType::i32, ModbusKind::holding, 300, 2),
                  signal(DataType::boolean, ModbusKind::bit, 4), signal(DataType::u16, ModbusKind::none, 0),
                  signal(DataType::boolean, ModbusKind::bit, 250)};
  return made;
}

TEST(ProcessTable, UnusedAddressesBelow200ReadZero) {
  const config::Drive model = drive();
  const ProcessTable table(model, config::WordOrder::big);
  EXPECT_TRUE(table.has_register(0));
  EXPECT_EQ(table.register_owner(0), kNoSignal);
  EXPECT_EQ(table.register_value(0), 0);
  EXPECT_TRUE(table.has_register(199));
  EXPECT_TRUE(table.has_bit(199));
  EXPECT_FALSE(table.bit_value(199));
}

TEST(ProcessTable, OtherAddressesExistOnlyWhereASignalIs) {
  const config::Drive model = drive();
  const ProcessTable table(model, config::WordOrder::big);
  EXPECT_FALSE(table.has_register(200));
  EXPECT_FALSE(table.has_register(299));
  EXPECT_TRUE(table.has_register(300));
  EXPECT_TRUE(table.has_register(301));
  EXPECT_FALSE(table.has_register(302));
  EXPECT_FALSE(table.has_register(65535));
  EXPECT_FALSE(table.has_bit(200));
  EXPECT_TRUE(table.has_bit(250));
  EXPECT_FALSE(table.has_bit(65535));
}

TEST(ProcessTable, ASignalFillsAllItsWords) {
  const config::Drive model = drive();
  ProcessTable table(model, config::WordOrder::big);
  table.set(1, static_cast<canopen::Raw>(-2));
  EXPECT_EQ(table.register_value(300), 0xFFFF);
  EXPECT_EQ(table.register_value(301), 0xFFFE);
  EXPECT_EQ(table.register_owner(300), 1);
  EXPECT_EQ(table.register_owner(301), 1);
  ProcessTable little(model, config::WordOrder::little);
  little.set(1, 0x00010002);
  EXPECT_EQ(little.register_value(300), 2);
  EXPECT_EQ(little.register_value(301), 1);
}

TEST(ProcessTable, BitsAndRegistersHaveAddressesOfTheirOwn) {
  const config::Drive model = drive();
  ProcessTable table(model, config::WordOrder::big);
  table.set(2, 1);
  EXPECT_TRUE(table.bit_value(4));
  EXPECT_EQ(table.register_value(4), 0);
  table.set(2, 0);
  EXPECT_FALSE(table.bit_value(4));
}

TEST(ProcessTable, ASignalWithoutAPlaceIsLeftAlone) {
  const config::Drive model = drive();
  ProcessTable table(model, config::WordOrder::big);
  table.set(3, 77);
  EXPECT_EQ(table.register_owner(0), kNoSignal);
  EXPECT_EQ(table.register_value(0), 0);
}

TEST(ProcessTable, TheLastAddressCanBeUsed) {
  config::Drive model;
  model.signals = {signal(DataType::u16, ModbusKind::holding, 65535)};
  ProcessTable table(model, config::WordOrder::big);
  table.set(0, 9);
  EXPECT_EQ(table.register_value(65535), 9);
}

}  // namespace
