#include "canopen/object.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace canopen {
namespace {

constexpr std::array kAllTypes{DataType::boolean, DataType::u8,  DataType::u16, DataType::u32,
                               DataType::u64,     DataType::i8,  DataType::i16, DataType::i32,
                               DataType::i64,     DataType::f32, DataType::f64};

TEST(ObjectAddress, IsWrittenWithPrefixAndLeadingZeros) {
  EXPECT_EQ(to_string(ObjectAddress{0x2021, 0x02}), "0x2021:02");
  EXPECT_EQ(to_string(ObjectAddress{0x000A, 0xFF}), "0x000A:FF");
}

TEST(ObjectAddress, IsReadInEveryDocumentedForm) {
  EXPECT_EQ(parse_object("0x2021:02"), (ObjectAddress{0x2021, 2}));
  EXPECT_EQ(parse_object("2021:1B"), (ObjectAddress{0x2021, 0x1B}));
  EXPECT_EQ(parse_object("0x1000"), (ObjectAddress{0x1000, 0}));
  EXPECT_EQ(parse_object("0x603f:0"), (ObjectAddress{0x603F, 0}));
}

TEST(ObjectAddress, AnyOtherTextIsNone) {
  for (const char* text : {"", "0x", ":", "0x2021:", ":02", "0x12345", "0x2021:100", "0x2021:02 ", " 0x2021",
                           "0x2021:0x2", "-1", "+2021", "20G1", "0x2021:02:03", "0x2021:-1"}) {
    EXPECT_EQ(parse_object(text), std::nullopt) << '"' << text << '"';
  }
}

TEST(DataTypes, NamesAreReadBack) {
  for (const DataType type : kAllTypes) {
    EXPECT_EQ(parse_type(name_of(type)), type);
  }
  EXPECT_EQ(parse_type("uint16"), std::nullopt);
  EXPECT_EQ(name_of(DataType::boolean), "bool");
  EXPECT_EQ(name_of(DataType::f64), "f64");
}

TEST(DataTypes, Lengths) {
  EXPECT_EQ(bit_length(DataType::boolean), 1U);
  EXPECT_EQ(byte_length(DataType::boolean), 1U);
  EXPECT_EQ(bit_length(DataType::i32), 32U);
  EXPECT_EQ(byte_length(DataType::f64), 8U);
  EXPECT_TRUE(is_signed(DataType::i8));
  EXPECT_FALSE(is_signed(DataType::f32));
  EXPECT_TRUE(is_real(DataType::f32));
  EXPECT_FALSE(is_real(DataType::i64));
}

TEST(RawValues, AreLittleEndianAndExtendedBySign) {
  const std::array<std::uint8_t, 8> bytes{0x88, 0x93, 0x01, 0x80, 0, 0, 0, 0xFF};
  EXPECT_EQ(decode_raw(DataType::u16, bytes), Raw{0x9388});
  EXPECT_EQ(decode_raw(DataType::i16, bytes), static_cast<Raw>(-27768));
  EXPECT_EQ(decode_raw(DataType::i8, bytes), static_cast<Raw>(-120));
  EXPECT_EQ(decode_raw(DataType::i32, bytes), static_cast<Raw>(std::int64_t{-2147380344}));
  EXPECT_EQ(decode_raw(DataType::u64, bytes), Raw{0xFF00000080019388});
}

TEST(RawValues, LongAnswersGiveTheirLowBits) {
  // The Goodrive answers 1801:03, a 16-bit object, with four bytes.
  const std::array<std::uint8_t, 4> bytes{0xE8, 0x03, 0x00, 0x00};
  EXPECT_EQ(decode_raw(DataType::u16, bytes), Raw{1000});
}

TEST(RawValues, ShortAnswersGiveNothing) {
  const std::array<std::uint8_t, 3> bytes{1, 2, 3};
  EXPECT_EQ(decode_raw(DataType::u32, bytes), std::nullopt);
  EXPECT_EQ(decode_raw(DataType::u8, std::span<const std::uint8_t>()), std::nullopt);
}

TEST(RawValues, EncodingGivesBackWhatWasDecoded) {
  const std::array<std::uint8_t, 8> bytes{0x01, 0x92, 0xA3, 0xB4, 0xC5, 0xD6, 0xE7, 0xF8};
  for (const DataType type : kAllTypes) {
    const auto raw = decode_raw(type, bytes);
    ASSERT_TRUE(raw);
    std::array<std::uint8_t, 8> out{};
    const unsigned count = encode_raw(type, *raw, out);
    EXPECT_EQ(count, byte_length(type));
    EXPECT_TRUE(std::equal(out.begin(), out.begin() + count, bytes.begin())) << name_of(type);
    EXPECT_EQ(normalise(type, *raw), *raw) << name_of(type);
  }
}

TEST(RawValues, NormaliseCutsAndExtends) {
  EXPECT_EQ(normalise(DataType::u8, 0x1FF), Raw{0xFF});
  EXPECT_EQ(normalise(DataType::i8, 0x1FF), static_cast<Raw>(-1));
  EXPECT_EQ(normalise(DataType::i16, 0x7FFF), Raw{0x7FFF});
  EXPECT_EQ(normalise(DataType::boolean, 3), Raw{1});
  EXPECT_EQ(normalise(DataType::f32, 0xFFFFFFFF00000000), Raw{0});
}

TEST(Numbers, OfRawValues) {
  EXPECT_EQ(to_number(DataType::u16, 4997), 4997.0);
  EXPECT_EQ(to_number(DataType::i16, 0xFFFF), -1.0);
  EXPECT_EQ(to_number(DataType::f32, std::bit_cast<std::uint32_t>(49.5F)), 49.5);
  EXPECT_EQ(to_number(DataType::f64, std::bit_cast<Raw>(-0.25)), -0.25);
  EXPECT_EQ(to_number(DataType::u64, ~Raw{0}), 18446744073709551616.0);
}

TEST(Numbers, AreRoundedToTheNearestStep) {
  EXPECT_EQ(from_number(DataType::u16, 4997.4), Raw{4997});
  EXPECT_EQ(from_number(DataType::u16, 4997.5), Raw{4998});
  EXPECT_EQ(from_number(DataType::i16, -2.5), static_cast<Raw>(-3));
  EXPECT_EQ(from_number(DataType::i64, -1e15), static_cast<Raw>(std::int64_t{-1000000000000000}));
}

TEST(Numbers, OutOfRangeIsRefusedBeforeRounding) {
  EXPECT_EQ(from_number(DataType::u16, 65535.0), Raw{65535});
  EXPECT_EQ(from_number(DataType::u16, 65535.4), std::nullopt);
  EXPECT_EQ(from_number(DataType::u16, -0.4), std::nullopt);
  EXPECT_EQ(from_number(DataType::i8, -128.0), static_cast<Raw>(-128));
  EXPECT_EQ(from_number(DataType::i8, -128.3), std::nullopt);
  EXPECT_EQ(from_number(DataType::boolean, 2.0), std::nullopt);
  EXPECT_EQ(from_number(DataType::u64, 18446744073709551616.0), std::nullopt);
  EXPECT_EQ(from_number(DataType::i64, 9223372036854775808.0), std::nullopt);
  EXPECT_EQ(from_number(DataType::i64, -9223372036854775808.0), Raw{1} << 63);
  EXPECT_EQ(from_number(DataType::f32, 1e39), std::nullopt);
}

TEST(Numbers, TheTraceOfADecimalScaleIsForgiven) {
  EXPECT_EQ(from_number(DataType::u16, 655.35 / 0.01), Raw{65535});
  EXPECT_EQ(from_number(DataType::u16, 65535.0 + 1e-9), Raw{65535});
  EXPECT_EQ(from_number(DataType::i16, -3276.8 / 0.1), static_cast<Raw>(-32768));
}

TEST(Numbers, NotANumberAndInfinityAreNone) {
  for (const DataType type : kAllTypes) {
    EXPECT_EQ(from_number(type, std::numeric_limits<double>::quiet_NaN()), std::nullopt) << name_of(type);
    EXPECT_EQ(from_number(type, std::numeric_limits<double>::infinity()), std::nullopt) << name_of(type);
    EXPECT_EQ(from_number(type, -std::numeric_limits<double>::infinity()), std::nullopt) << name_of(type);
  }
}

}  // namespace
}  // namespace canopen
