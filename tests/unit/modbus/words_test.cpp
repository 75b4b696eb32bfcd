#include "bridges/modbus/words.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/unit/modbus/bytes.h"

namespace {

using canopen::DataType;
using canopen::Raw;
using config::WordOrder;
using modbus_test::hex;

config::Signal signal(DataType type, std::uint16_t count, bool as_float = false, double scale = 1.0) {
  config::Signal made;
  made.type = type;
  made.scale = scale;
  made.modbus = {.kind = config::ModbusKind::holding, .address = 0, .count = count, .as_float = as_float};
  return made;
}

std::vector<std::uint16_t> shown(const config::Signal& what, Raw raw, WordOrder order = WordOrder::big) {
  std::vector<std::uint16_t> words(what.modbus.count);
  modbus::put_value(what, raw, order, words);
  return words;
}

Raw written(const config::Signal& what, std::string_view bytes, WordOrder order = WordOrder::big) {
  return std::get<Raw>(modbus::value_of(what, hex(bytes), order));
}

Raw raw_of(std::int64_t number) {
  return static_cast<Raw>(number);
}

using Words = std::vector<std::uint16_t>;

TEST(Words, SmallValuesAreExtendedBySign) {
  EXPECT_EQ(shown(signal(DataType::u16, 1), 4997), Words{4997});
  EXPECT_EQ(shown(signal(DataType::i16, 1), raw_of(-2)), Words{0xFFFE});
  EXPECT_EQ(shown(signal(DataType::i8, 1), raw_of(-2)), Words{0xFFFE});
  EXPECT_EQ(shown(signal(DataType::i8, 1), 0xFE), Words{0xFFFE});
  EXPECT_EQ(shown(signal(DataType::u8, 1), 0xFE), Words{0x00FE});
  EXPECT_EQ(shown(signal(DataType::boolean, 1), 1), Words{1});
}

TEST(Words, TheOrderConcernsWordsNeverBytes) {
  const config::Signal wide = signal(DataType::u32, 2);
  EXPECT_EQ(shown(wide, 0x11223344), (Words{0x1122, 0x3344}));
  EXPECT_EQ(shown(wide, 0x11223344, WordOrder::little), (Words{0x3344, 0x1122}));
  const config::Signal widest = signal(DataType::u64, 4);
  EXPECT_EQ(shown(widest, 0x1122334455667788), (Words{0x1122, 0x3344, 0x5566, 0x7788}));
  EXPECT_EQ(shown(widest, 0x1122334455667788, WordOrder::little), (Words{0x7788, 0x5566, 0x3344, 0x1122}));
  EXPECT_EQ(shown(signal(DataType::i32, 2), raw_of(-2)), (Words{0xFFFF, 0xFFFE}));
}

TEST(Words, RealsAreIeee754) {
  EXPECT_EQ(shown(signal(DataType::f32, 2), std::bit_cast<std::uint32_t>(1.5F)), (Words{0x3FC0, 0x0000}));
  EXPECT_EQ(shown(signal(DataType::f64, 4), std::bit_cast<Raw>(1.5)), (Words{0x3FF8, 0, 0, 0}));
}

TEST(Words, AsFloatShowsEngineeringUnits) {
  const config::Signal frequency = signal(DataType::u16, 2, true, 0.01);
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(49.97F);
  const Words expected{static_cast<std::uint16_t>(bits >> 16), static_cast<std::uint16_t>(bits)};
  EXPECT_EQ(shown(frequency, 4997), expected);
  EXPECT_EQ(shown(frequency, 4997, WordOrder::little), (Words{expected[1], expected[0]}));
  const std::uint32_t negative = std::bit_cast<std::uint32_t>(-0.5F);
  EXPECT_EQ(shown(signal(DataType::i16, 2, true, 0.5), raw_of(-1)),
            (Words{static_cast<std::uint16_t>(negative >> 16), static_cast<std::uint16_t>(negative)}));
}

TEST(Words, WrittenWordsBecomeRawValues) {
  EXPECT_EQ(written(signal(DataType::u16, 1), "ffff"), Raw{0xFFFF});
  EXPECT_EQ(written(signal(DataType::i16, 1), "fffe"), raw_of(-2));
  EXPECT_EQ(written(signal(DataType::u32, 2), "1122 3344"), Raw{0x11223344});
  EXPECT_EQ(written(signal(DataType::u32, 2), "3344 1122", WordOrder::little), Raw{0x11223344});
  EXPECT_EQ(written(signal(DataType::i32, 2), "ffff fffe"), raw_of(-2));
  EXPECT_EQ(written(signal(DataType::u64, 4), "1122 3344 5566 7788"), Raw{0x1122334455667788});
  EXPECT_EQ(written(signal(DataType::f32, 2), "3fc0 0000"), Raw{0x3FC00000});
}

TEST(Words, WhatTheTypeCanNotHoldIsLeftToTheArbiter) {
  EXPECT_EQ(written(signal(DataType::u8, 1), "00ff"), Raw{255});
  EXPECT_EQ(written(signal(DataType::u8, 1), "0100"), Raw{0x100});
  EXPECT_EQ(written(signal(DataType::i8, 1), "ff80"), raw_of(-128));
  EXPECT_EQ(written(signal(DataType::i8, 1), "ff7f"), raw_of(-129));
  EXPECT_EQ(written(signal(DataType::i8, 1), "0080"), raw_of(128));
  EXPECT_EQ(written(signal(DataType::boolean, 1), "0001"), Raw{1});
  EXPECT_EQ(written(signal(DataType::boolean, 1), "0002"), Raw{2});
}

double number_of(float number) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(number);
  const modbus_test::Bytes bytes{static_cast<std::uint8_t>(bits >> 24), static_cast<std::uint8_t>(bits >> 16),
                                 static_cast<std::uint8_t>(bits >> 8), static_cast<std::uint8_t>(bits)};
  return std::get<double>(modbus::value_of(signal(DataType::u16, 2, true, 0.01), bytes, WordOrder::big));
}

TEST(Words, AFloatIsTheDecimalNumberThatIsMeantByIt) {
  EXPECT_EQ(number_of(49.97F), 49.97);  // not 49.970001220703125, which a limit of 49.97 would refuse
  EXPECT_EQ(number_of(0.1F), 0.1);
  EXPECT_EQ(number_of(-50.0F), -50.0);
  EXPECT_EQ(number_of(0.0F), 0.0);
  EXPECT_EQ(number_of(16777216.0F), 16777216.0);
  EXPECT_TRUE(std::isnan(number_of(std::numeric_limits<float>::quiet_NaN())));
  EXPECT_TRUE(std::isinf(number_of(std::numeric_limits<float>::infinity())));
}

}  // namespace
