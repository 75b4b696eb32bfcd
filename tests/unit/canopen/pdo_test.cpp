#include "canopen/node/pdo.h"

#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <vector>

namespace canopen {
namespace {

MappedObject mapped(std::uint16_t index, DataType type, std::uint8_t bits) {
  return {.object = {index, 0}, .type = type, .bits = bits};
}

std::vector<Raw> decode(const PdoPlan& plan, const std::vector<std::uint8_t>& bytes) {
  std::vector<Raw> values(plan.field_count());
  EXPECT_TRUE(plan.decode(bytes, values));
  return values;
}

TEST(Pdo, FourWordsOfVeichiTpdo1) {
  const std::vector<MappedObject> mapping{mapped(0x2030, DataType::u16, 16), mapped(0x2021, DataType::u16, 16),
                                          mapped(0x2021, DataType::u16, 16), mapped(0x2021, DataType::i16, 16)};
  const PdoPlan plan(mapping);
  EXPECT_EQ(plan.byte_count(), 8U);
  EXPECT_EQ(decode(plan, {0x81, 0x00, 0x7B, 0x00, 0x85, 0x13, 0xFF, 0xFF}),
            (std::vector<Raw>{0x81, 123, 4997, static_cast<Raw>(-1)}));
}

TEST(Pdo, FieldsMayBeginAtAnyBit) {
  const std::vector<MappedObject> mapping{mapped(0x2001, DataType::boolean, 1), mapped(0x2002, DataType::u8, 3),
                                          mapped(0x2003, DataType::i16, 12), mapped(0x2004, DataType::u32, 24)};
  const PdoPlan plan(mapping);
  EXPECT_EQ(plan.byte_count(), 5U);
  // Bits from the low end: 1, 101, 1000 0000 0001 (-2047), then 0xABCDEF.
  EXPECT_EQ(decode(plan, {0x1B, 0x80, 0xEF, 0xCD, 0xAB}), (std::vector<Raw>{1, 5, static_cast<Raw>(-2047), 0xABCDEF}));
}

TEST(Pdo, SixtyFourBits) {
  const std::vector<MappedObject> wide{mapped(0x2001, DataType::u64, 64)};
  EXPECT_EQ(decode(PdoPlan(wide), {1, 2, 3, 4, 5, 6, 7, 0x88}), (std::vector<Raw>{0x8807060504030201}));
  const std::vector<MappedObject> real{mapped(0x2001, DataType::f64, 64)};
  EXPECT_EQ(to_number(DataType::f64, decode(PdoPlan(real), {0, 0, 0, 0, 0, 0, 0xF8, 0xBF}).front()), -1.5);
  std::vector<MappedObject> bits(64, mapped(0x2001, DataType::boolean, 1));
  EXPECT_EQ(PdoPlan(bits).field_count(), 64U);
}

TEST(Pdo, DummiesAreSkipped) {
  const std::vector<MappedObject> mapping{mapped(0x0005, DataType::u8, 8), mapped(0x6041, DataType::u16, 16),
                                          mapped(0x0007, DataType::u32, 32)};
  const PdoPlan plan(mapping);
  EXPECT_EQ(decode(plan, {0xFF, 0x37, 0x12, 0xFF, 0xFF, 0xFF, 0xFF}), (std::vector<Raw>{0, 0x1237, 0}));
  const auto bytes = plan.encode(std::vector<Raw>{0xAA, 0x1237, 0xBBBBBBBB});
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 8>{0, 0x37, 0x12, 0, 0, 0, 0, 0}));
}

TEST(Pdo, ShorterIsNeverDecoded) {
  const std::vector<MappedObject> mapping{mapped(0x2030, DataType::u16, 16), mapped(0x2021, DataType::u16, 16),
                                          mapped(0x2021, DataType::u16, 16)};
  const PdoPlan plan(mapping);
  std::vector<Raw> values(3, 77);
  for (const std::size_t length : {0U, 1U, 5U}) {
    EXPECT_FALSE(plan.decode(std::vector<std::uint8_t>(length, 0x11), values)) << length;
  }
  EXPECT_EQ(values, (std::vector<Raw>{77, 77, 77}));
  EXPECT_TRUE(plan.decode(std::vector<std::uint8_t>(6, 0x11), values));
  EXPECT_FALSE(plan.decode(std::vector<std::uint8_t>(6, 0x11), std::span(values).first(2)));
}

TEST(Pdo, OfALongerOneTheFirstBytesCount) {
  const std::vector<MappedObject> mapping{mapped(0x2030, DataType::u16, 16), mapped(0x2021, DataType::i16, 16),
                                          mapped(0x2022, DataType::u8, 4)};
  const PdoPlan plan(mapping);
  const std::vector<Raw> wanted{0x81, static_cast<Raw>(-1), 0x5};
  EXPECT_EQ(decode(plan, {0x81, 0x00, 0xFF, 0xFF, 0xF5}), wanted);
  EXPECT_EQ(decode(plan, {0x81, 0x00, 0xFF, 0xFF, 0xF5, 0xAA}), wanted);
  EXPECT_EQ(decode(plan, {0x81, 0x00, 0xFF, 0xFF, 0xF5, 0xAA, 0xBB, 0xCC}), wanted);
}

TEST(Pdo, ATypeNarrowerThanItsMappingTakesItsOwnBits) {
  const std::vector<MappedObject> mapping{mapped(0x2001, DataType::i16, 32), mapped(0x2002, DataType::boolean, 8)};
  const PdoPlan plan(mapping);
  EXPECT_EQ(decode(plan, {0xFE, 0xFF, 0x00, 0x00, 0x01}), (std::vector<Raw>{static_cast<Raw>(-2), 1}));
  const auto bytes = plan.encode(std::vector<Raw>{static_cast<Raw>(-2), 1});
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 8>{0xFE, 0xFF, 0xFF, 0xFF, 0x01, 0, 0, 0}));
}

TEST(Pdo, MappingsThatDoNotFitAreRefused) {
  EXPECT_THROW(PdoPlan(std::vector<MappedObject>{mapped(0x2001, DataType::u8, 0)}), std::invalid_argument);
  EXPECT_THROW(PdoPlan(std::vector<MappedObject>{mapped(0x2001, DataType::u64, 65)}), std::invalid_argument);
  EXPECT_THROW(PdoPlan(std::vector<MappedObject>{mapped(0x2001, DataType::u64, 64), mapped(0x2002, DataType::u8, 1)}),
               std::invalid_argument);
  EXPECT_EQ(PdoPlan(std::vector<MappedObject>{}).byte_count(), 0U);
}

// Decoded again, every encoded value is what its type can hold of it, whatever the mapping.
TEST(Pdo, RandomMappingsGiveBackTheirValues) {
  std::mt19937_64 random(20260102);
  for (int round = 0; round < 2000; ++round) {
    std::vector<MappedObject> mapping;
    std::vector<Raw> values;
    for (unsigned left = 64; left > 0 && mapping.size() < 10;) {
      const auto bits = static_cast<std::uint8_t>(1 + random() % left);
      const DataType type = random() % 2 == 0 ? DataType::u64 : DataType::i64;
      mapping.push_back(mapped(0x2001, type, bits));
      const Raw kept = random() & (bits == 64 ? ~Raw{0} : (Raw{1} << bits) - 1);
      const bool negative = type == DataType::i64 && (kept >> (bits - 1)) != 0;
      values.push_back(negative && bits < 64 ? kept | (~Raw{0} << bits) : kept);
      left -= bits;
    }
    const PdoPlan plan(mapping);
    const auto bytes = plan.encode(values);
    std::vector<Raw> decoded(values.size());
    ASSERT_TRUE(plan.decode(std::span(bytes).first(plan.byte_count()), decoded));
    ASSERT_EQ(decoded, values) << "round " << round;
  }
}

}  // namespace
}  // namespace canopen
