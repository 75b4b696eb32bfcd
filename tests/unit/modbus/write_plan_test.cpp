#include "bridges/modbus/write_plan.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/modbus/bytes.h"

namespace {

using canopen::DataType;
using canopen::Raw;
using config::Access;
using config::ModbusKind;
using modbus::Exception;
using modbus::ProcessTable;
using modbus::Range;
using modbus::WritePlan;
using modbus_test::hex;

config::Signal signal(Access access, DataType type, ModbusKind kind, std::uint16_t address, std::uint16_t count = 1) {
  config::Signal made;
  made.access = access;
  made.type = type;
  made.modbus = {.kind = kind, .address = address, .count = count};
  return made;
}

class WritePlanTest : public testing::Test {
 protected:
  static config::Drive drive() {
    config::Drive made;
    made.signals = {signal(Access::read, DataType::u16, ModbusKind::holding, 99),
                    signal(Access::write, DataType::u16, ModbusKind::holding, 100),
                    signal(Access::write, DataType::i32, ModbusKind::holding, 101, 2),
                    signal(Access::read_write, DataType::u8, ModbusKind::holding, 103),
                    signal(Access::write, DataType::boolean, ModbusKind::bit, 8),
                    signal(Access::write, DataType::boolean, ModbusKind::bit, 9),
                    signal(Access::read, DataType::boolean, ModbusKind::bit, 10)};
    return made;
  }

  [[nodiscard]] std::string registers(Range range, const std::string& bytes) const {
    return text(modbus::plan_registers(table_, range, hex(bytes)));
  }
  [[nodiscard]] std::string bits(Range range, const std::string& bytes) const {
    return text(modbus::plan_bits(table_, range, hex(bytes)));
  }

 private:
  static std::string text(const WritePlan& plan) {
    std::string all;
    for (const process::FieldWrite& field : plan.fields) {
      all += std::to_string(field.signal) + "=" +
             std::to_string(static_cast<std::int64_t>(std::get<Raw>(field.value))) + " ";
    }
    return plan.mistake ? all + "exception " + std::to_string(static_cast<int>(*plan.mistake)) : all;
  }

  const config::Drive model_ = drive();
  const ProcessTable table_{model_, config::WordOrder::big};
};

TEST_F(WritePlanTest, TakesOneOrManyWholeValues) {
  EXPECT_EQ(registers({100, 1}, "0007"), "1=7 ");
  EXPECT_EQ(registers({101, 2}, "ffff fffe"), "2=-2 ");
  EXPECT_EQ(registers({100, 4}, "0007 0001 0000 00ff"), "1=7 2=65536 3=255 ");
}

TEST_F(WritePlanTest, HalfOfAWideValueIsNoAddress) {
  EXPECT_EQ(registers({101, 1}, "0001"), "exception 2");
  EXPECT_EQ(registers({102, 1}, "0001"), "exception 2");
  EXPECT_EQ(registers({100, 2}, "0001 0001"), "1=1 exception 2");
  EXPECT_EQ(registers({102, 2}, "0001 0001"), "3=1 exception 2");
}

TEST_F(WritePlanTest, OneAddressThatTakesNoValueIsAMistake) {
  EXPECT_EQ(registers({99, 1}, "0001"), "exception 2");
  EXPECT_EQ(registers({99, 2}, "0001 0001"), "1=1 exception 2");
  EXPECT_EQ(registers({103, 2}, "0001 0001"), "3=1 exception 2");
  EXPECT_EQ(registers({104, 1}, "0001"), "exception 2");
  EXPECT_EQ(registers({500, 1}, "0001"), "exception 2");
  EXPECT_EQ(registers({1000, 1}, "0001"), "exception 2");
  EXPECT_EQ(registers({1020, 2}, "0001 0000"), "exception 2");
}

/// A drive with a control command and one set-point, at 100 and 102, and a value that is only read at 103.
class SparsePlanTest : public testing::Test {
 protected:
  static config::Drive drive() {
    config::Drive made;
    made.signals = {signal(Access::write, DataType::u16, ModbusKind::holding, 100),
                    signal(Access::write, DataType::u16, ModbusKind::holding, 102),
                    signal(Access::read, DataType::u16, ModbusKind::holding, 103)};
    return made;
  }
  [[nodiscard]] std::size_t fields(Range range, const std::string& bytes) const {
    const WritePlan plan = modbus::plan_registers(table_, range, hex(bytes));
    return plan.mistake ? 0 : plan.fields.size();
  }

 private:
  const config::Drive model_ = drive();
  const ProcessTable table_{model_, config::WordOrder::big};
};

TEST_F(SparsePlanTest, AnUnusedRegisterBesideTheControlCommandTakesAnIgnoredZero) {
  EXPECT_EQ(fields({100, 2}, "0007 0000"), 1U);
  EXPECT_EQ(fields({100, 3}, "0007 0000 0001"), 2U);
  EXPECT_EQ(fields({100, 2}, "0007 0001"), 0U) << "any other value";
  EXPECT_EQ(fields({100, 3}, "0007 0100 0001"), 0U);
  EXPECT_EQ(fields({101, 1}, "0000"), 0U) << "without 100";
  EXPECT_EQ(fields({101, 2}, "0000 0001"), 0U);
  EXPECT_EQ(fields({100, 4}, "0007 0000 0001 0000"), 0U) << "103 is used, and takes no value";
  EXPECT_EQ(fields({99, 3}, "0000 0007 0000"), 0U) << "99 is no such register";
}

TEST_F(WritePlanTest, AValueBeyondTheTypeIsNotCut) {
  EXPECT_EQ(registers({103, 1}, "0100"), "3=256 ");
}

TEST_F(WritePlanTest, BitsComeLowestFirst) {
  EXPECT_EQ(bits({8, 1}, "01"), "4=1 ");
  EXPECT_EQ(bits({8, 2}, "02"), "4=0 5=1 ");
  EXPECT_EQ(bits({8, 3}, "07"), "4=1 5=1 exception 2");
  EXPECT_EQ(bits({7, 2}, "03"), "4=1 exception 2");
  EXPECT_EQ(bits({200, 1}, "01"), "exception 2");
}

}  // namespace
