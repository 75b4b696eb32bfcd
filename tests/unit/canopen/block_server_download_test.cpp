#include <gtest/gtest.h>

#include "tests/support/block_server.h"
#include "tests/unit/canopen/block_server_bench.h"

// What the client writes and the server answers, byte by byte from the figures of CiA 301 §7.2.4.3.8 to 11.
namespace support {
namespace {

using namespace block_server_bench;

class BlockServerDownload : public testing::Test {
 protected:
  BlockServerDownload() { server_.objects[kObject] = letters("old"); }

  /// 30 bytes, 00 to 1D, are five segments.
  void initiate_thirty_bytes(const Answers& answers) { EXPECT_EQ(say(server_, "C6 00 20 01 1E 00 00 00"), answers); }

  BlockServer server_{5};
};

TEST(BlockServerCrc, IsTheOneOfTheStandard) {
  EXPECT_EQ(block::crc16(letters("123456789")), 0x31C3);
  EXPECT_EQ(block::crc16(std::vector<std::uint8_t>{}), 0);
  // Reckoned by binascii.crc_hqx.
  EXPECT_EQ(block::crc16(counting(30)), 0x1F11);
  EXPECT_EQ(block::crc16(std::vector<std::uint8_t>{0xFF}), 0x1EF0);
}

TEST_F(BlockServerDownload, OneSubBlockWithCrcAndSize) {
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), kNoAnswer);
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("old"));
  EXPECT_FALSE(server_.idle());
  EXPECT_EQ(say(server_, "D5 C3 31 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("123456789"));
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerDownload, WithoutCrcAndWithoutSize) {
  EXPECT_EQ(say(server_, "C0 00 20 01 00 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "81 37 38 00 00 00 00 00"), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 00 00 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("78"));
}

TEST_F(BlockServerDownload, AFullLastSegmentHasNoUnusedBytes) {
  EXPECT_EQ(say(server_, "C2 00 20 01 07 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "81 61 62 63 64 65 66 67"), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "C1 00 00 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("abcdefg"));
}

TEST_F(BlockServerDownload, SubBlocksOfDifferentSizesCountFromOneEach) {
  server_.faults.block_sizes = {2, 1, 127};
  initiate_thirty_bytes({"A4 00 20 01 02 00 00 00"});
  EXPECT_EQ(say(server_, "01 00 01 02 03 04 05 06"), kNoAnswer);
  EXPECT_EQ(say(server_, "02 07 08 09 0A 0B 0C 0D"), Answers{"A2 02 01 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "01 0E 0F 10 11 12 13 14"), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "01 15 16 17 18 19 1A 1B"), kNoAnswer);
  EXPECT_EQ(say(server_, "82 1C 1D 00 00 00 00 00"), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 11 1F 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], counting(30));
}

TEST_F(BlockServerDownload, WhatFollowsAGapIsDiscardedAndComesInTheNextSubBlock) {
  server_.faults.block_sizes = {4};
  initiate_thirty_bytes({"A4 00 20 01 04 00 00 00"});
  EXPECT_EQ(say(server_, "01 00 01 02 03 04 05 06"), kNoAnswer);
  EXPECT_EQ(say(server_, "03 0E 0F 10 11 12 13 14"), kNoAnswer);
  EXPECT_EQ(say(server_, "04 15 16 17 18 19 1A 1B"), Answers{"A2 01 04 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "01 07 08 09 0A 0B 0C 0D"), kNoAnswer);
  EXPECT_EQ(say(server_, "02 0E 0F 10 11 12 13 14"), kNoAnswer);
  EXPECT_EQ(say(server_, "03 15 16 17 18 19 1A 1B"), kNoAnswer);
  EXPECT_EQ(say(server_, "84 1C 1D 00 00 00 00 00"), Answers{"A2 04 04 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 11 1F 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], counting(30));
}

TEST_F(BlockServerDownload, WithoutItsFirstSegmentASubBlockIsAcknowledgedWithZero) {
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"A2 00 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), kNoAnswer);
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 C3 31 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
}

TEST_F(BlockServerDownload, ARepeatedSegmentCountsOnce) {
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), kNoAnswer);
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), kNoAnswer);
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 C3 31 00 00 00 00 00"), Answers{"A1 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("123456789"));
}

TEST_F(BlockServerDownload, ASegmentThatLooksLikeACommandIsASegment) {
  // 0x40 would begin an upload, 0xC2 a block download.
  EXPECT_EQ(say(server_, "C2 00 20 01 09 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), kNoAnswer);
  EXPECT_EQ(say(server_, "C2 00 20 01 09 00 00 00"), Answers{"A2 00 7F 00 00 00 00 00"});
  EXPECT_FALSE(server_.idle());
}

TEST_F(BlockServerDownload, ASequenceNumberOutsideTheSubBlockEndsIt) {
  server_.faults.block_sizes = {4};
  initiate_thirty_bytes({"A4 00 20 01 04 00 00 00"});
  EXPECT_EQ(say(server_, "05 00 01 02 03 04 05 06"), Answers{"80 00 20 01 03 00 04 05"});
  EXPECT_TRUE(server_.idle());
  initiate_thirty_bytes({"A4 00 20 01 04 00 00 00"});
  EXPECT_EQ(say(server_, "00 00 01 02 03 04 05 06"), Answers{"80 00 20 01 03 00 04 05"});
}

TEST_F(BlockServerDownload, AWrongCrcChangesNothing) {
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), kNoAnswer);
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 31 C3 00 00 00 00 00"), Answers{"80 00 20 01 04 00 04 05"});
  EXPECT_EQ(server_.objects[kObject], letters("old"));
}

TEST_F(BlockServerDownload, OtherLengthThanIndicatedChangesNothing) {
  EXPECT_EQ(say(server_, "C2 00 20 01 0A 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), kNoAnswer);
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 00 00 00 00 00 00 00"), Answers{"80 00 20 01 10 00 07 06"});
  EXPECT_EQ(say(server_, "C2 00 20 01 08 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "01 31 32 33 34 35 36 37"), kNoAnswer);
  EXPECT_EQ(say(server_, "82 38 39 00 00 00 00 00"), Answers{"A2 02 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 00 00 00 00 00 00 00"), Answers{"80 00 20 01 10 00 07 06"});
  EXPECT_EQ(server_.objects[kObject], letters("old"));
}

TEST_F(BlockServerDownload, AnObjectOfFixedLengthRefusesOthers) {
  server_.fixed_lengths = {kObject};
  EXPECT_EQ(say(server_, "C2 00 20 01 04 00 00 00"), Answers{"80 00 20 01 12 00 07 06"});
  EXPECT_EQ(say(server_, "C2 00 20 01 02 00 00 00"), Answers{"80 00 20 01 13 00 07 06"});
  EXPECT_EQ(say(server_, "C0 00 20 01 00 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "81 37 38 39 00 00 00 00"), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "CD 00 00 00 00 00 00 00"), Answers{"80 00 20 01 12 00 07 06"});
  EXPECT_EQ(server_.objects[kObject], letters("old"));
}

TEST_F(BlockServerDownload, NeedsAnObject) {
  EXPECT_EQ(say(server_, "C6 01 20 00 09 00 00 00"), Answers{"80 01 20 00 00 00 02 06"});
  EXPECT_EQ(say(server_, "C6 00 20 02 09 00 00 00"), Answers{"80 00 20 02 11 00 09 06"});
  server_.refused[kObject] = 0x06010002;
  EXPECT_EQ(say(server_, "C6 00 20 01 09 00 00 00"), Answers{"80 00 20 01 02 00 01 06"});
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerDownload, TheEndNeedsATransferAndWhatIsReservedIsZero) {
  EXPECT_EQ(say(server_, "D5 00 00 00 00 00 00 00"), Answers{"80 00 00 00 01 00 04 05"});
  EXPECT_EQ(say(server_, "C0 00 20 01 00 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "81 37 38 00 00 00 00 00"), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 00 00 01 00 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "C0 00 20 01 00 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "81 37 38 00 00 00 00 00"), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D7 00 00 00 00 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "C0 00 20 01 01 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "C8 00 20 01 00 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(server_.objects[kObject], letters("old"));
}

TEST_F(BlockServerDownload, ACrcThatWasNotAgreedIsZero) {
  EXPECT_EQ(say(server_, "C0 00 20 01 00 00 00 00"), Answers{"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "81 37 38 00 00 00 00 00"), Answers{"A2 01 7F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "D5 01 00 00 00 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
}

TEST_F(BlockServerDownload, TheClientsAbortEndsItWithoutAnAnswer) {
  initiate_thirty_bytes({"A4 00 20 01 7F 00 00 00"});
  EXPECT_EQ(say(server_, "01 00 01 02 03 04 05 06"), kNoAnswer);
  EXPECT_EQ(say(server_, "80 00 20 01 00 00 04 05"), kNoAnswer);
  EXPECT_TRUE(server_.idle());
  ASSERT_EQ(server_.aborts_heard().size(), 1U);
  EXPECT_EQ(server_.aborts_heard()[0], (block::Abort{kObject, 0x05040000}));
  EXPECT_EQ(server_.objects[kObject], letters("old"));
}

}  // namespace
}  // namespace support
