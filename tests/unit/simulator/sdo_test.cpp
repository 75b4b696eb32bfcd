#include <gtest/gtest.h>

#include <string>

#include "tests/unit/simulator/test_bench.h"

namespace simulator {
namespace {

constexpr std::uint8_t kServer = 6;

std::optional<std::string> upload_text(Bench& bench, std::uint16_t index) {
  const auto low = static_cast<std::uint8_t>(index);
  const auto high = static_cast<std::uint8_t>(index >> 8U);
  auto answer = bench.sdo(kServer, {0x40, low, high, 0, 0, 0, 0, 0});
  if (!answer || answer->data[0] != 0x41) {
    return std::nullopt;
  }
  const std::size_t size = answer->data[4];
  std::string text;
  for (std::uint8_t toggle = 0;; toggle ^= 0x10U) {
    answer = bench.sdo(kServer, {static_cast<std::uint8_t>(0x60U | toggle), 0, 0, 0, 0, 0, 0, 0});
    if (!answer || (answer->data[0] & 0xF0U) != toggle) {
      return std::nullopt;
    }
    const std::size_t used = 7U - ((answer->data[0] >> 1U) & 7U);
    text.append(answer->data.begin() + 1, answer->data.begin() + 1 + static_cast<std::ptrdiff_t>(used));
    if ((answer->data[0] & 1U) != 0) {
      return text.size() == size ? std::optional(text) : std::nullopt;
    }
  }
}

TEST(Sdo, StringsAreUploadedInSegments) {
  OneDrive bench("vacon-opte6", kServer);
  EXPECT_EQ(upload_text(bench, 0x1008), "Vacon drive with OPTE6 (simulated)");
  EXPECT_EQ(bench.drive().record().sdo_reads.at({0x1008, 0}), 1U);
}

TEST(Sdo, StringsAreDownloadedInSegments) {
  OneDrive bench("cia402-velocity", kServer);
  EXPECT_EQ(bench.sdo(kServer, {0x21, 0x00, 0x2F, 0, 10, 0, 0, 0}), frame(0x586, {0x60, 0x00, 0x2F, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bench.sdo(kServer, {0x00, 'c', 'o', 'n', 'v', 'e', 'y', 'o'}), frame(0x586, {0x20, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(bench.sdo(kServer, {0x19, 'r', ' ', '4', 0, 0, 0, 0}), frame(0x586, {0x30, 0, 0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(upload_text(bench, 0x2F00), "conveyor 4");
  EXPECT_EQ(bench.drive().record().sdo_writes.at({0x2F00, 0}), 1U);
}

TEST(Sdo, NumbersMayComeInSegmentsToo) {
  OneDrive bench("cia402-velocity", kServer);
  ASSERT_TRUE(bench.sdo(kServer, {0x21, 0x17, 0x10, 0, 2, 0, 0, 0}).has_value());
  ASSERT_TRUE(bench.sdo(kServer, {0x0B, 0xE8, 0x03, 0, 0, 0, 0, 0}).has_value());
  EXPECT_EQ(bench.read(kServer, 0x1017, 0), 1000U);
  ASSERT_TRUE(bench.sdo(kServer, {0x21, 0x17, 0x10, 0, 3, 0, 0, 0}).has_value());
  EXPECT_EQ(bench.sdo(kServer, {0x09, 1, 2, 3, 0, 0, 0, 0}),
            frame(0x586, {0x80, 0x17, 0x10, 0, 0x10, 0x00, 0x07, 0x06}));
}

TEST(Sdo, AWrongToggleEndsTheTransfer) {
  OneDrive bench("vacon-opte6", kServer);
  ASSERT_TRUE(bench.sdo(kServer, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0}).has_value());
  EXPECT_EQ(bench.sdo(kServer, {0x70, 0, 0, 0, 0, 0, 0, 0}),
            frame(0x586, {0x80, 0x08, 0x10, 0, 0x00, 0x00, 0x03, 0x05}));
  EXPECT_EQ(bench.sdo(kServer, {0x60, 0, 0, 0, 0, 0, 0, 0}),
            frame(0x586, {0x80, 0x08, 0x10, 0, 0x01, 0x00, 0x04, 0x05}));
}

TEST(Sdo, TheMastersAbortEndsTheTransferInSilence) {
  OneDrive bench("vacon-opte6", kServer);
  ASSERT_TRUE(bench.sdo(kServer, {0x40, 0x08, 0x10, 0, 0, 0, 0, 0}).has_value());
  EXPECT_FALSE(bench.sdo(kServer, {0x80, 0x08, 0x10, 0, 0, 0, 0x04, 0x05}).has_value());
  EXPECT_EQ(bench.sdo(kServer, {0x60, 0, 0, 0, 0, 0, 0, 0})->data[0], 0x80);
}

TEST(Sdo, AbortsSayWhy) {
  OneDrive bench("cia402-velocity", kServer);
  EXPECT_EQ(bench.read_abort(kServer, 0x5000, 0), 0x06020000U);
  EXPECT_EQ(bench.read_abort(kServer, 0x1018, 9), 0x06090011U);
  EXPECT_EQ(bench.write(kServer, 0x6041, 0, 0, 2), 0x06010002U);
  EXPECT_EQ(bench.write(kServer, 0x6040, 0, 0, 4), 0x06070010U);
  EXPECT_EQ(bench.write(kServer, 0x6060, 0, 3, 1), 0x06090030U);
  EXPECT_EQ(bench.read_abort(kServer, 0x1003, 1), 0x08000024U);
  const auto block_upload = bench.sdo(kServer, {0xA0, 0x08, 0x10, 0, 0, 0, 0, 0});
  EXPECT_EQ(block_upload, frame(0x586, {0x80, 0x08, 0x10, 0, 0x01, 0x00, 0x04, 0x05}));
  EXPECT_EQ(bench.drive().record().sdo_refusals.at({0x5000, 0}), 1U);
  EXPECT_FALSE(bench.drive().record().sdo_writes.contains({0x6040, 0}));
}

TEST(Sdo, TheLengthMayBeLeftToTheDictionary) {
  OneDrive bench("cia402-velocity", kServer);
  EXPECT_EQ(bench.sdo(kServer, {0x22, 0x17, 0x10, 0, 0xE8, 0x03, 0, 0})->data[0], 0x60);
  EXPECT_EQ(bench.read(kServer, 0x1017, 0), 1000U);
}

TEST(Sdo, OnlyVeichiTakesShortRequests) {
  OneDrive by_the_book("cia402-velocity", kServer);
  EXPECT_FALSE(by_the_book.sdo(kServer, {0x40, 0x00, 0x10, 0}).has_value());
  OneDrive veichi("veichi-ac310", kServer);
  EXPECT_TRUE(veichi.sdo(kServer, {0x40, 0x00, 0x10, 0}).has_value());
  EXPECT_TRUE(veichi.sdo(kServer, {0x2B, 0x30, 0x20, 0x07, 0x64, 0x00}).has_value());
  EXPECT_FALSE(veichi.sdo(kServer, {0x2B, 0x30, 0x20, 0x07, 0x64}).has_value());
  EXPECT_FALSE(veichi.sdo(kServer, {0x40, 0x00, 0x10}).has_value());
  EXPECT_FALSE(veichi.sdo(kServer, {}).has_value());
}

}  // namespace
}  // namespace simulator
