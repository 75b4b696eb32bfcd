#include <gtest/gtest.h>

#include "tests/support/block_server.h"
#include "tests/unit/canopen/block_server_bench.h"

// What the client reads and the server answers, byte by byte from the figures of CiA 301 §7.2.4.3.12 to 15.
namespace support {
namespace {

using namespace block_server_bench;

class BlockServerUpload : public testing::Test {
 protected:
  BlockServerUpload() { server_.objects[kObject] = counting(30); }

  BlockServer server_{5};
};

TEST_F(BlockServerUpload, OneSubBlockWithCrcAndSize) {
  server_.objects[kObject] = letters("123456789");
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 09 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), (Answers{"01 31 32 33 34 35 36 37", "82 38 39 00 00 00 00 00"}));
  EXPECT_EQ(say(server_, "A2 02 7F 00 00 00 00 00"), Answers{"D5 C3 31 00 00 00 00 00"});
  EXPECT_FALSE(server_.idle());
  EXPECT_EQ(say(server_, "A1 00 00 00 00 00 00 00"), kNoAnswer);
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerUpload, WithoutCrcTheFieldIsZero) {
  server_.objects[kObject] = letters("abcdefg");
  EXPECT_EQ(say(server_, "A0 00 20 01 01 00 00 00"), Answers{"C6 00 20 01 07 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), Answers{"81 61 62 63 64 65 66 67"});
  EXPECT_EQ(say(server_, "A2 01 01 00 00 00 00 00"), Answers{"C1 00 00 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "A1 00 00 00 00 00 00 00"), kNoAnswer);
}

TEST_F(BlockServerUpload, SubBlocksOfDifferentSizesCountFromOneEach) {
  EXPECT_EQ(say(server_, "A4 00 20 01 02 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), (Answers{"01 00 01 02 03 04 05 06", "02 07 08 09 0A 0B 0C 0D"}));
  EXPECT_EQ(say(server_, "A2 02 01 00 00 00 00 00"), Answers{"01 0E 0F 10 11 12 13 14"});
  EXPECT_EQ(say(server_, "A2 01 7F 00 00 00 00 00"), (Answers{"01 15 16 17 18 19 1A 1B", "82 1C 1D 00 00 00 00 00"}));
  EXPECT_EQ(say(server_, "A2 02 7F 00 00 00 00 00"), Answers{"D5 11 1F 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "A1 00 00 00 00 00 00 00"), kNoAnswer);
}

TEST_F(BlockServerUpload, WhatWasNotAcknowledgedComesInTheNextSubBlock) {
  EXPECT_EQ(say(server_, "A4 00 20 01 03 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"),
            (Answers{"01 00 01 02 03 04 05 06", "02 07 08 09 0A 0B 0C 0D", "03 0E 0F 10 11 12 13 14"}));
  EXPECT_EQ(say(server_, "A2 01 03 00 00 00 00 00"),
            (Answers{"01 07 08 09 0A 0B 0C 0D", "02 0E 0F 10 11 12 13 14", "03 15 16 17 18 19 1A 1B"}));
  EXPECT_EQ(say(server_, "A2 00 02 00 00 00 00 00"), (Answers{"01 07 08 09 0A 0B 0C 0D", "02 0E 0F 10 11 12 13 14"}));
  EXPECT_EQ(say(server_, "A2 02 02 00 00 00 00 00"), (Answers{"01 15 16 17 18 19 1A 1B", "82 1C 1D 00 00 00 00 00"}));
  EXPECT_EQ(say(server_, "A2 01 02 00 00 00 00 00"), Answers{"81 1C 1D 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "A2 01 02 00 00 00 00 00"), Answers{"D5 11 1F 00 00 00 00 00"});
}

TEST_F(BlockServerUpload, DataWithoutAByteAreOneSegmentWithoutAByte) {
  server_.objects[kObject] = {};
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 00 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), Answers{"81 00 00 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "A2 01 7F 00 00 00 00 00"), Answers{"DD 00 00 00 00 00 00 00"});
}

TEST_F(BlockServerUpload, ABlockSizeIsOneTo127) {
  EXPECT_EQ(say(server_, "A4 00 20 01 00 00 00 00"), Answers{"80 00 20 01 02 00 04 05"});
  EXPECT_EQ(say(server_, "A4 00 20 01 80 00 00 00"), Answers{"80 00 20 01 02 00 04 05"});
  EXPECT_EQ(say(server_, "A4 00 20 01 01 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), Answers{"01 00 01 02 03 04 05 06"});
  EXPECT_EQ(say(server_, "A2 01 00 00 00 00 00 00"), Answers{"80 00 20 01 02 00 04 05"});
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerUpload, ASegmentThatWasNotSentIsNotAcknowledged) {
  EXPECT_EQ(say(server_, "A4 00 20 01 01 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), Answers{"01 00 01 02 03 04 05 06"});
  EXPECT_EQ(say(server_, "A2 02 01 00 00 00 00 00"), Answers{"80 00 20 01 03 00 04 05"});
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerUpload, EachSubcommandHasItsTime) {
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), Answers{"80 00 00 00 01 00 04 05"});
  for (const char* early : {"A2 01 7F 00 00 00 00 00", "A1 00 00 00 00 00 00 00"}) {
    EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
    EXPECT_EQ(say(server_, early), Answers{"80 00 20 01 01 00 04 05"});
    EXPECT_TRUE(server_.idle());
  }
  for (const char* wrong :
       {"A3 00 00 00 00 00 00 00", "A1 00 00 00 00 00 00 00", "A2 01 7F 01 00 00 00 00", "A6 01 7F 00 00 00 00 00"}) {
    EXPECT_EQ(say(server_, "A4 00 20 01 01 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
    EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), Answers{"01 00 01 02 03 04 05 06"});
    EXPECT_EQ(say(server_, wrong), Answers{"80 00 20 01 01 00 04 05"}) << wrong;
    EXPECT_TRUE(server_.idle());
  }
}

TEST_F(BlockServerUpload, ANewInitiateTakesTheOldOnesPlace) {
  server_.objects[{0x2001, 0}] = letters("xy");
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
  EXPECT_EQ(say(server_, "A4 01 20 00 7F 00 00 00"), Answers{"C6 01 20 00 02 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), Answers{"81 78 79 00 00 00 00 00"});
}

TEST_F(BlockServerUpload, NeedsAnObjectAndItsReservedBytesAreZero) {
  EXPECT_EQ(say(server_, "A4 01 20 00 7F 00 00 00"), Answers{"80 01 20 00 00 00 02 06"});
  EXPECT_EQ(say(server_, "A4 00 20 02 7F 00 00 00"), Answers{"80 00 20 02 11 00 09 06"});
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 01 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "AC 00 20 01 7F 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
}

TEST_F(BlockServerUpload, TheClientsAbortEndsItWithoutAnAnswer) {
  EXPECT_EQ(say(server_, "A4 00 20 01 01 00 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
  EXPECT_EQ(say(server_, "A3 00 00 00 00 00 00 00"), Answers{"01 00 01 02 03 04 05 06"});
  EXPECT_EQ(say(server_, "80 00 20 01 04 00 04 05"), kNoAnswer);
  EXPECT_TRUE(server_.idle());
  ASSERT_EQ(server_.aborts_heard().size(), 1U);
  EXPECT_EQ(server_.aborts_heard()[0], (block::Abort{kObject, 0x05040004}));
}

TEST_F(BlockServerUpload, IsAnsweredByTheUploadProtocolWhereTheThresholdAllowsIt) {
  server_.faults.protocol_switch = block::ProtocolSwitch::where_allowed;
  server_.objects[kObject] = letters("123456789");
  // Not allowed, and too small.
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 09 00 00 00"});
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 08 00 00"), Answers{"C6 00 20 01 09 00 00 00"});
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 09 00 00"), Answers{"41 00 20 01 09 00 00 00"});
  EXPECT_EQ(say(server_, "60 00 00 00 00 00 00 00"), Answers{"00 31 32 33 34 35 36 37"});
  EXPECT_EQ(say(server_, "70 00 00 00 00 00 00 00"), Answers{"1B 38 39 00 00 00 00 00"});
  // A threshold of 0 allows it to no size.
  server_.objects[kObject] = {};
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"C6 00 20 01 00 00 00 00"});
  server_.objects[kObject] = letters("ab");
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 09 00 00"), Answers{"4B 00 20 01 61 62 00 00"});
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerUpload, IsAnsweredByTheUploadProtocolAgainstTheThreshold) {
  server_.faults.protocol_switch = block::ProtocolSwitch::always;
  EXPECT_EQ(say(server_, "A4 00 20 01 7F 00 00 00"), Answers{"41 00 20 01 1E 00 00 00"});
  server_.faults.protocol_switch = block::ProtocolSwitch::never;
  EXPECT_EQ(say(server_, "A4 00 20 01 7F FF 00 00"), Answers{"C6 00 20 01 1E 00 00 00"});
}

}  // namespace
}  // namespace support
