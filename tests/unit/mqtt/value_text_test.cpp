#include "bridges/mqtt/value_text.h"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <string>

#include "tests/unit/mqtt/site.h"

namespace mqtt {
namespace {

using canopen::DataType;
using canopen::Raw;

std::string text_of(DataType type, double scale, unsigned decimals, Raw raw, Shape shape = Shape::number) {
  config::Signal signal;
  signal.type = type;
  signal.scale = scale;
  signal.decimals = decimals;
  signal.values = {{3, "stopped"}, {-1, "below"}};
  std::string text;
  return append_value(text, signal, shape, raw) ? text : "none";
}

TEST(ValueText, HasTheDecimalsOfItsScale) {
  EXPECT_EQ(text_of(DataType::u16, 0.01, 2, 4997), "49.97");
  EXPECT_EQ(text_of(DataType::u16, 0.01, 2, 5000), "50.00");
  EXPECT_EQ(text_of(DataType::u16, 0.01, 2, 7), "0.07");
  EXPECT_EQ(text_of(DataType::u16, 0.1, 1, 0), "0.0");
  EXPECT_EQ(text_of(DataType::u16, 1.0, 0, 1450), "1450");
  EXPECT_EQ(text_of(DataType::u16, 10.0, 0, 12), "120");
  EXPECT_EQ(text_of(DataType::u16, 0.5, 1, 5), "2.5");
}

TEST(ValueText, KeepsTheSign) {
  EXPECT_EQ(text_of(DataType::i16, 0.01, 2, static_cast<Raw>(-7)), "-0.07");
  EXPECT_EQ(text_of(DataType::i16, 0.5, 0, static_cast<Raw>(std::int64_t{-300})), "-150");
  EXPECT_EQ(text_of(DataType::i64, 1.0, 0, static_cast<Raw>(std::numeric_limits<std::int64_t>::min())),
            "-9223372036854775808");
}

TEST(ValueText, HoldsAllDigitsOf64Bits) {
  EXPECT_EQ(text_of(DataType::u64, 1.0, 0, 18446744073709551615U), "18446744073709551615");
  EXPECT_EQ(text_of(DataType::u64, 0.001, 3, 18446744073709551615U), "18446744073709551.615");
}

TEST(ValueText, OfRealsIsShortestWithoutAScaleAndNothingWithoutANumber) {
  EXPECT_EQ(text_of(DataType::f32, 1.0, 0, std::bit_cast<std::uint32_t>(49.97F)), "49.97");
  EXPECT_EQ(text_of(DataType::f64, 1.0, 0, std::bit_cast<Raw>(0.1)), "0.1");
  EXPECT_EQ(text_of(DataType::f64, 1.0, 2, std::bit_cast<Raw>(-0.001)), "0.00");
  EXPECT_EQ(text_of(DataType::f64, 1.0, 0, std::bit_cast<Raw>(std::numeric_limits<double>::quiet_NaN())), "none");
  EXPECT_EQ(text_of(DataType::f32, 1.0, 2, std::bit_cast<std::uint32_t>(std::numeric_limits<float>::infinity())),
            "none");
  EXPECT_EQ(text_of(DataType::f64, 1.0, 2, std::bit_cast<Raw>(std::numeric_limits<double>::max())).size(), 312U);
}

TEST(ValueText, OfBooleansAndNames) {
  EXPECT_EQ(text_of(DataType::u16, 1.0, 0, 1, Shape::boolean), "true");
  EXPECT_EQ(text_of(DataType::u16, 1.0, 0, 0, Shape::boolean), "false");
  EXPECT_EQ(text_of(DataType::u8, 1.0, 0, 3, Shape::name), "stopped");
  EXPECT_EQ(text_of(DataType::u8, 1.0, 0, 17, Shape::name), "unknown(17)");
  EXPECT_EQ(text_of(DataType::i8, 1.0, 0, static_cast<Raw>(-1), Shape::name), "below");
  EXPECT_EQ(text_of(DataType::i8, 1.0, 0, static_cast<Raw>(-2), Shape::name), "unknown(-2)");
}

TEST(ValueText, ASignalHasOneShape) {
  const config::Drive drive = test::pump1();
  EXPECT_EQ(shape_of(drive, test::kFrequency), Shape::number);
  EXPECT_EQ(shape_of(drive, test::kState), Shape::name);
  EXPECT_EQ(shape_of(drive, test::kRunning), Shape::boolean);
  EXPECT_EQ(shape_of(drive, test::kSwitch), Shape::boolean);
  EXPECT_EQ(shape_of(drive, test::kFaultCode), Shape::number) << "even with names";
}

}  // namespace
}  // namespace mqtt
