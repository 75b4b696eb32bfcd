#include "config/text.h"

#include <gtest/gtest.h>

#include <chrono>

namespace config {
namespace {

using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

TEST(Durations, AreReadWithTheirUnit) {
  EXPECT_EQ(parse_duration("500ms"), milliseconds(500));
  EXPECT_EQ(parse_duration("0s"), seconds(0));
  EXPECT_EQ(parse_duration("1.5s"), milliseconds(1500));
  EXPECT_EQ(parse_duration("10min"), minutes(10));
  EXPECT_EQ(parse_duration("2h"), hours(2));
  EXPECT_EQ(parse_duration("250us"), microseconds(250));
}

TEST(Durations, OfAnyOtherFormAreNone) {
  for (const auto* const text : {"", "5", "ms", "-5s", " 5s", "5 s", "5s ", "5S", "1e3s", "inf s", "nan", "0x5s",
                                 "99999999999999h", "5.s.", ".5s", "1d"}) {
    EXPECT_EQ(parse_duration(text), std::nullopt) << text;
  }
}

TEST(Durations, AreWrittenInTheLargestUnitThatDividesThem) {
  EXPECT_EQ(to_text(seconds(0)), "0s");
  EXPECT_EQ(to_text(milliseconds(1500)), "1500ms");
  EXPECT_EQ(to_text(seconds(90)), "90s");
  EXPECT_EQ(to_text(minutes(10)), "10min");
  EXPECT_EQ(to_text(hours(24)), "24h");
}

TEST(Sizes, AreReadWithTheirUnit) {
  EXPECT_EQ(parse_size("50MB"), 50'000'000U);
  EXPECT_EQ(parse_size("1.5GB"), 1'500'000'000U);
  EXPECT_EQ(parse_size("1.1kB"), 1100U);
  EXPECT_EQ(parse_size("7B"), 7U);
  EXPECT_EQ(parse_size("1000000GB"), 1'000'000'000'000'000U);
}

TEST(Sizes, OfAnyOtherFormAreNone) {
  for (const auto* const text : {"", "50", "MB", "-5MB", " 5MB", "5 MB", "5mb", "5KB", "5MiB", "1e3MB", "nanMB",
                                 "0x5MB", "1.5B", "0.0001kB", "1000001GB", "99999999999999999999GB"}) {
    EXPECT_EQ(parse_size(text), std::nullopt) << text;
  }
}

TEST(Sizes, AreWrittenInTheLargestUnitThatDividesThem) {
  EXPECT_EQ(size_text(50'000'000), "50MB");
  EXPECT_EQ(size_text(1'500'000'000), "1500MB");
  EXPECT_EQ(size_text(2'000'000'000), "2GB");
  EXPECT_EQ(size_text(1001), "1001B");
  EXPECT_EQ(size_text(0), "0B");
}

TEST(Integers, AreDecimalOrHexadecimal) {
  EXPECT_EQ(parse_integer("17"), 17);
  EXPECT_EQ(parse_integer("-3"), -3);
  EXPECT_EQ(parse_integer("0x1F"), 31);
  for (const auto* const text : {"", "-", "0x", "1x", "--1", "+1", "99999999999999999999", "1.0"}) {
    EXPECT_EQ(parse_integer(text), std::nullopt) << text;
  }
}

TEST(Numbers, AreWrittenShortAndWithoutExponent) {
  EXPECT_EQ(to_text(0.01), "0.01");
  EXPECT_EQ(to_text(50.0), "50");
  EXPECT_EQ(to_text(-1500.0), "-1500");
  EXPECT_EQ(to_text(655.35), "655.35");
}

TEST(Names, AreThoseOfTheContract) {
  EXPECT_TRUE(is_name("line-3_A"));
  EXPECT_TRUE(is_name(std::string(32, 'a')));
  EXPECT_FALSE(is_name(std::string(33, 'a')));
  EXPECT_FALSE(is_name(""));
  EXPECT_FALSE(is_name("a/b"));
  EXPECT_FALSE(is_name("pümp"));
  EXPECT_TRUE(is_signal_name("output_frequency2"));
  EXPECT_FALSE(is_signal_name("2nd"));
  EXPECT_FALSE(is_signal_name("Output"));
  EXPECT_FALSE(is_signal_name("a-b"));
}

TEST(MappedObjects, AreAnObjectAndAType) {
  const auto mapped = parse_mapped("0x2021:0B u16");
  ASSERT_TRUE(mapped.has_value());
  EXPECT_EQ(mapped->first, (canopen::ObjectAddress{0x2021, 0x0B}));
  EXPECT_EQ(mapped->second, canopen::DataType::u16);
  EXPECT_FALSE(parse_mapped("0x2021:0B").has_value());
  EXPECT_FALSE(parse_mapped("0x2021:0B u17").has_value());
  EXPECT_FALSE(parse_mapped("u16 0x2021:0B").has_value());
}

TEST(CobIds, MayContainTheNodeId) {
  EXPECT_EQ(parse_cob_id("$NODEID+0x180"), (CobId{0x180, true}));
  EXPECT_EQ(parse_cob_id("0x180 + $NODEID"), (CobId{0x180, true}));
  EXPECT_EQ(parse_cob_id("0x1A0"), (CobId{0x1A0, false}));
  for (const auto* const text : {"", "$NODEID", "$NODEID+", "0x180+5", "$NODEID+0x800", "$NODEID+-1", "-5", "0x800"}) {
    EXPECT_EQ(parse_cob_id(text), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace config
