#include "canopen/node/emcy.h"

#include <gtest/gtest.h>

#include <vector>

namespace canopen {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr EmcySettings kVeichi{.layout = EmcyLayout::drive_code};
constexpr EmcySettings kGoodrive{.layout = EmcyLayout::class_and_vendor40};
constexpr EmcySettings kOpte6{.layout = EmcyLayout::cia301, .reset_counts_remaining = true, .drive_code_under = 0x1000};
constexpr EmcySettings kCia{};

TEST(Emcy, Ac310FaultIsItsOwnCode) {
  const auto emcy = decode_emcy(kVeichi, Bytes{0x05, 0x00, 0x01, 0x05, 0x00, 0x00, 0x00, 0x00});
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->code, 0x0005);
  EXPECT_EQ(emcy->error_register, 0x01);
  EXPECT_EQ(emcy->drive_code, 5U);
  EXPECT_EQ(emcy->vendor, (std::array<std::uint8_t, 5>{5, 0, 0, 0, 0}));
  EXPECT_FALSE(emcy->reset);
}

TEST(Emcy, Ac300OvercurrentIsNoReset) {
  // Fault 0x0004 is an overcurrent during acceleration; CiA 301 would call 0x00xx "error reset".
  const Bytes frame{0x04, 0x00, 0x01, 0x04, 0x00, 0x00, 0x00, 0x00};
  const auto emcy = decode_emcy(kVeichi, frame);
  ASSERT_TRUE(emcy);
  EXPECT_FALSE(emcy->reset);
  EXPECT_EQ(emcy->drive_code, 4U);
  EXPECT_TRUE(decode_emcy(kCia, frame)->reset);
}

TEST(Emcy, VeichiResetIsCodeZero) {
  const auto emcy = decode_emcy(kVeichi, Bytes{0, 0, 0, 0, 0, 0, 0, 0});
  ASSERT_TRUE(emcy);
  EXPECT_TRUE(emcy->reset);
  EXPECT_EQ(emcy->drive_code, std::nullopt);
  EXPECT_EQ(emcy->remaining, 0);
}

TEST(Emcy, GoodriveCarriesItsFaultIn40Bits) {
  const auto emcy = decode_emcy(kGoodrive, Bytes{0x00, 0x30, 0x04, 0x01, 0x00, 0x00, 0x00, 0x00});
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->code, 0x3000);
  EXPECT_EQ(emcy->error_register, 0x04);
  EXPECT_EQ(emcy->drive_code, 1U);
  EXPECT_FALSE(emcy->reset);

  const auto wide = decode_emcy(kGoodrive, Bytes{0x00, 0x30, 0x04, 0x01, 0x02, 0x03, 0x04, 0x85});
  EXPECT_EQ(wide->drive_code, 0x8504030201U);
}

TEST(Emcy, GoodriveClearsWithZeros) {
  const auto emcy = decode_emcy(kGoodrive, Bytes(8, 0));
  ASSERT_TRUE(emcy);
  EXPECT_TRUE(emcy->reset);
  EXPECT_EQ(emcy->drive_code, std::nullopt);
}

TEST(Emcy, Opte6CountsWhatRemains) {
  const auto partial = decode_emcy(kOpte6, Bytes{0x00, 0x00, 0x01, 0x02, 0x00, 0x00, 0x00, 0x00});
  ASSERT_TRUE(partial);
  EXPECT_TRUE(partial->reset);
  EXPECT_EQ(partial->remaining, 2);
  EXPECT_EQ(decode_emcy(kOpte6, Bytes(8, 0))->remaining, 0);
  // Elsewhere that byte counts nothing.
  EXPECT_EQ(decode_emcy(kCia, Bytes{0, 0, 0, 2, 0, 0, 0, 0})->remaining, 0);
}

TEST(Emcy, Opte6DriveFaultComesUnder1000) {
  const auto fault = decode_emcy(kOpte6, Bytes{0x00, 0x10, 0x01, 0x03, 0x00, 0x00, 0x00, 0x00});
  ASSERT_TRUE(fault);
  EXPECT_EQ(fault->drive_code, 3U);
  EXPECT_EQ(fault->remaining, 0);
  // Several codes, or a wider one: only the bytes are told.
  EXPECT_EQ(decode_emcy(kOpte6, Bytes{0x00, 0x10, 0x01, 0x03, 0x00, 0x09, 0x00, 0x00})->drive_code, std::nullopt);
  // Any other code is one of CiA 301.
  EXPECT_EQ(decode_emcy(kOpte6, Bytes{0x30, 0x81, 0x11, 0x01, 0x7F, 0x00, 0x00, 0x00})->drive_code, std::nullopt);
}

TEST(Emcy, ResetWithARegisterLeftIsPartial) {
  // Lenze 8400 clears one of several errors so.
  const auto emcy = decode_emcy(kCia, Bytes{0x00, 0x00, 0x11, 0, 0, 0, 0, 0});
  ASSERT_TRUE(emcy);
  EXPECT_TRUE(emcy->reset);
  EXPECT_EQ(emcy->error_register, 0x11);
}

TEST(Emcy, CiaResetIsTheWholeClass00) {
  EXPECT_TRUE(decode_emcy(kCia, Bytes{0x42, 0x00, 0x00})->reset);
  EXPECT_FALSE(decode_emcy(kCia, Bytes{0x00, 0x10, 0x01})->reset);
}

TEST(Emcy, ShortFramesReadAsZerosOrNothing) {
  const auto emcy = decode_emcy(kVeichi, Bytes{0x05, 0x00, 0x01, 0x05});
  ASSERT_TRUE(emcy);
  EXPECT_EQ(emcy->vendor, (std::array<std::uint8_t, 5>{5, 0, 0, 0, 0}));
  EXPECT_EQ(decode_emcy(kVeichi, Bytes{0x05, 0x00}), std::nullopt);
  EXPECT_EQ(decode_emcy(kVeichi, Bytes{}), std::nullopt);
}

}  // namespace
}  // namespace canopen
