#include "config/value_check.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace config {
namespace {

using canopen::DataType;
using canopen::ErrorKind;
using canopen::Raw;

Signal signal(DataType type, double scale, std::optional<double> min = {}, std::optional<double> max = {}) {
  Signal signal;
  signal.name = "x";
  signal.type = type;
  signal.access = Access::write;
  signal.scale = scale;
  signal.decimals = scale == 0.01 ? 2 : (scale == 0.1 ? 1 : 0);
  signal.min = min;
  signal.max = max;
  return signal;
}

const Signal kFrequency = signal(DataType::u16, 0.01, 0.0, 50.0);
const Signal kTorque = signal(DataType::i16, 0.1, -150.0, 150.0);

std::optional<Raw> accepted(const Signal& signal, double value) {
  const auto raw = check_value(signal, value);
  return raw.has_value() ? std::optional(raw.value()) : std::nullopt;
}

std::optional<ErrorKind> refused(const Signal& signal, std::variant<Raw, double> value) {
  const auto raw = check_value(signal, value);
  return raw.has_error() ? std::optional(raw.error().kind) : std::nullopt;
}

Raw negative(std::int64_t value) {
  return static_cast<Raw>(value);
}

TEST(ValueCheck, EngineeringUnitsBecomeRawSteps) {
  EXPECT_EQ(accepted(kFrequency, 49.97), 4997U);
  EXPECT_EQ(accepted(kFrequency, 0.0), 0U);
  EXPECT_EQ(accepted(kTorque, -12.3), negative(-123));
}

TEST(ValueCheck, BetweenTwoStepsTheNearestCounts) {
  EXPECT_EQ(accepted(kFrequency, 12.344), 1234U);
  EXPECT_EQ(accepted(kFrequency, 12.346), 1235U);
  EXPECT_EQ(accepted(kTorque, -0.26), negative(-3));
}

TEST(ValueCheck, LimitItselfIsAllowedAndNothingBeyondItBeforeRounding) {
  EXPECT_EQ(accepted(kFrequency, 50.0), 5000U);
  EXPECT_EQ(refused(kFrequency, 50.004), ErrorKind::range);  // Rounded it would be 50.00.
  EXPECT_EQ(refused(kFrequency, 50.0001), ErrorKind::range);
  EXPECT_EQ(refused(kFrequency, -0.001), ErrorKind::range);
  EXPECT_EQ(refused(kFrequency, 1e300), ErrorKind::range);
  EXPECT_EQ(accepted(kTorque, -150.0), negative(-1500));
  EXPECT_EQ(refused(kTorque, -150.04), ErrorKind::range);
}

TEST(ValueCheck, DecimalLimitsAndValuesAreExactForPeople) {
  // 0.29 / 0.01 is 28.999999999999996.
  for (int step = 1; step <= 5000; ++step) {
    const Signal limited = signal(DataType::u16, 0.01, 0.0, step / 100.0);
    EXPECT_EQ(accepted(limited, step / 100.0), static_cast<Raw>(step));
    EXPECT_EQ(refused(limited, Raw{static_cast<unsigned>(step)}), std::nullopt);
    EXPECT_EQ(refused(limited, Raw{static_cast<unsigned>(step + 1)}), ErrorKind::range);
    EXPECT_EQ(refused(limited, (step + 0.01) / 100.0), ErrorKind::range);
  }
}

TEST(ValueCheck, WithoutLimitsTheTypeHolds) {
  const Signal plain = signal(DataType::u16, 0.01);
  EXPECT_EQ(accepted(plain, 655.35), 65535U);
  EXPECT_EQ(refused(plain, 655.354), ErrorKind::range);
  EXPECT_EQ(refused(plain, -0.01), ErrorKind::range);
  const Signal wide = signal(DataType::i32, 1.0);
  EXPECT_EQ(accepted(wide, -2147483648.0), negative(-2147483648LL));
  EXPECT_EQ(refused(wide, 2147483648.0), ErrorKind::range);
}

TEST(ValueCheck, NotANumberAndInfinityAreTypeErrors) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Signal real = signal(DataType::f32, 1.0);
  for (const Signal& each : {kFrequency, kTorque, real}) {
    EXPECT_EQ(refused(each, nan), ErrorKind::type);
    EXPECT_EQ(refused(each, infinity), ErrorKind::type);
    EXPECT_EQ(refused(each, -infinity), ErrorKind::type);
  }
  EXPECT_EQ(refused(real, Raw{std::bit_cast<std::uint32_t>(static_cast<float>(nan))}), ErrorKind::type);
  EXPECT_EQ(refused(real, Raw{std::bit_cast<std::uint32_t>(static_cast<float>(infinity))}), ErrorKind::type);
}

TEST(ValueCheck, RawValuesHaveTheSameLimits) {
  EXPECT_EQ(refused(kFrequency, Raw{5000}), std::nullopt);
  EXPECT_EQ(refused(kFrequency, Raw{5001}), ErrorKind::range);
  EXPECT_EQ(refused(kTorque, negative(-1500)), std::nullopt);
  EXPECT_EQ(refused(kTorque, negative(-1501)), ErrorKind::range);
  EXPECT_EQ(refused(kTorque, Raw{0xFFFF}), ErrorKind::range);  // Not extended by its sign: no i16.
  EXPECT_EQ(refused(kFrequency, Raw{0x10000}), ErrorKind::range);
}

TEST(ValueCheck, FloatLimitsAllowTheirOwnNearestFloat) {
  const Signal real = signal(DataType::f32, 1.0, 0.1, 50.1);
  EXPECT_EQ(refused(real, Raw{std::bit_cast<std::uint32_t>(50.1F)}), std::nullopt);
  EXPECT_EQ(refused(real, Raw{std::bit_cast<std::uint32_t>(0.1F)}), std::nullopt);
  EXPECT_EQ(refused(real, Raw{std::bit_cast<std::uint32_t>(50.2F)}), ErrorKind::range);
  EXPECT_EQ(refused(real, 50.11), ErrorKind::range);
  EXPECT_EQ(refused(real, 1e39), ErrorKind::range);
}

TEST(ValueCheck, NegativeScaleTurnsTheLimitsAround) {
  const Signal turned = signal(DataType::i16, -0.1, 0.0, 10.0);
  EXPECT_EQ(accepted(turned, 10.0), negative(-100));
  EXPECT_EQ(refused(turned, 10.1), ErrorKind::range);
  EXPECT_EQ(refused(turned, -0.1), ErrorKind::range);
}

TEST(ValueCheck, EnumerationDoesNotRestrictWrites) {
  Signal command = signal(DataType::u16, 1.0);
  command.values = {{1, "forward"}, {5, "stop"}};
  EXPECT_EQ(accepted(command, 9.0), 9U);
}

TEST(ValueCheck, ErrorNamesTheRange) {
  EXPECT_EQ(check_value(kFrequency, 60.0).error().detail, "out of range 0..50");
  EXPECT_EQ(range_text(kTorque), "-150..150");
  EXPECT_EQ(range_text(signal(DataType::u16, 0.01)), "0..655.35");
  EXPECT_EQ(range_text(signal(DataType::i16, 0.1)), "-3276.8..3276.7");
  EXPECT_EQ(range_text(signal(DataType::u16, 0.01, 0.5)), "0.5..655.35");
  EXPECT_EQ(range_text(signal(DataType::boolean, 1.0)), "0..1");
}

}  // namespace
}  // namespace config
