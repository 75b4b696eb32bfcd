#include <gtest/gtest.h>

#include <array>

#include "tests/support/block_server.h"
#include "tests/unit/canopen/block_server_bench.h"

// Expedited and segmented transfers, byte by byte from the figures of CiA 301 §7.2.4.3.2 to 7.
namespace support {
namespace {

using namespace block_server_bench;

class BlockServerSegmented : public testing::Test {
 protected:
  BlockServerSegmented() { server_.objects[kObject] = letters("123456789"); }

  BlockServer server_{5};
};

TEST_F(BlockServerSegmented, OneToFourBytesAreReadAtOnce) {
  server_.objects = {{{0x2000, 1}, {0x11}},
                     {{0x2000, 2}, {0x11, 0x22}},
                     {{0x2000, 3}, {0x11, 0x22, 0x33}},
                     {{0x2000, 4}, {0x11, 0x22, 0x33, 0x44}}};
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"4F 00 20 01 11 00 00 00"});
  EXPECT_EQ(say(server_, "40 00 20 02 00 00 00 00"), Answers{"4B 00 20 02 11 22 00 00"});
  EXPECT_EQ(say(server_, "40 00 20 03 00 00 00 00"), Answers{"47 00 20 03 11 22 33 00"});
  EXPECT_EQ(say(server_, "40 00 20 04 00 00 00 00"), Answers{"43 00 20 04 11 22 33 44"});
}

TEST_F(BlockServerSegmented, MoreAreReadInSegments) {
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"41 00 20 01 09 00 00 00"});
  EXPECT_EQ(say(server_, "60 00 00 00 00 00 00 00"), Answers{"00 31 32 33 34 35 36 37"});
  EXPECT_EQ(say(server_, "70 00 00 00 00 00 00 00"), Answers{"1B 38 39 00 00 00 00 00"});
  EXPECT_TRUE(server_.idle());
  server_.objects[kObject] = letters("abcdefg");
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"41 00 20 01 07 00 00 00"});
  EXPECT_EQ(say(server_, "60 00 00 00 00 00 00 00"), Answers{"01 61 62 63 64 65 66 67"});
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerSegmented, NoByteIsReadAsOneSegmentWithoutAByte) {
  server_.objects[kObject] = {};
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"41 00 20 01 00 00 00 00"});
  EXPECT_EQ(say(server_, "60 00 00 00 00 00 00 00"), Answers{"0F 00 00 00 00 00 00 00"});
}

TEST_F(BlockServerSegmented, OneToFourBytesAreWrittenAtOnce) {
  EXPECT_EQ(say(server_, "2F 00 20 01 61 00 00 00"), Answers{"60 00 20 01 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("a"));
  EXPECT_EQ(say(server_, "23 00 20 01 61 62 63 64"), Answers{"60 00 20 01 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("abcd"));
  EXPECT_EQ(say(server_, "2B 00 20 01 78 79 63 64"), Answers{"60 00 20 01 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("xy"));
  // The number of bytes is not said: as many as the object has.
  EXPECT_EQ(say(server_, "22 00 20 01 76 77 63 64"), Answers{"60 00 20 01 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("vw"));
}

TEST_F(BlockServerSegmented, MoreAreWrittenInSegments) {
  EXPECT_EQ(say(server_, "21 00 20 01 10 00 00 00"), Answers{"60 00 20 01 00 00 00 00"});
  EXPECT_EQ(say(server_, "00 61 62 63 64 65 66 67"), Answers{"20 00 00 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "10 68 69 6A 6B 6C 6D 6E"), Answers{"30 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("123456789"));
  EXPECT_EQ(say(server_, "0B 6F 70 00 00 00 00 00"), Answers{"20 00 00 00 00 00 00 00"});
  EXPECT_EQ(server_.objects[kObject], letters("abcdefghijklmnop"));
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerSegmented, OtherLengthThanIndicatedChangesNothing) {
  EXPECT_EQ(say(server_, "21 00 20 01 08 00 00 00"), Answers{"60 00 20 01 00 00 00 00"});
  EXPECT_EQ(say(server_, "01 61 62 63 64 65 66 67"), Answers{"80 00 20 01 10 00 07 06"});
  EXPECT_EQ(server_.objects[kObject], letters("123456789"));
  EXPECT_EQ(say(server_, "21 00 20 01 06 00 00 00"), Answers{"60 00 20 01 00 00 00 00"});
  EXPECT_EQ(say(server_, "01 61 62 63 64 65 66 67"), Answers{"80 00 20 01 10 00 07 06"});
  server_.fixed_lengths = {kObject};
  EXPECT_EQ(say(server_, "21 00 20 01 08 00 00 00"), Answers{"80 00 20 01 13 00 07 06"});
  EXPECT_EQ(say(server_, "23 00 20 01 61 62 63 64"), Answers{"80 00 20 01 13 00 07 06"});
}

TEST_F(BlockServerSegmented, TheToggleBitAlternatesFromZero) {
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"41 00 20 01 09 00 00 00"});
  EXPECT_EQ(say(server_, "70 00 00 00 00 00 00 00"), Answers{"80 00 20 01 00 00 03 05"});
  EXPECT_EQ(say(server_, "20 00 20 01 00 00 00 00"), Answers{"60 00 20 01 00 00 00 00"});
  EXPECT_EQ(say(server_, "00 61 62 63 64 65 66 67"), Answers{"20 00 00 00 00 00 00 00"});
  EXPECT_EQ(say(server_, "00 61 62 63 64 65 66 67"), Answers{"80 00 20 01 00 00 03 05"});
  EXPECT_TRUE(server_.idle());
}

TEST_F(BlockServerSegmented, WhatIsNoRequestOfTheStandardIsAnUnknownCommand) {
  EXPECT_EQ(say(server_, "60 00 00 00 00 00 00 00"), Answers{"80 00 00 00 01 00 04 05"});
  EXPECT_EQ(say(server_, "00 61 62 63 64 65 66 67"), Answers{"80 00 00 00 01 00 04 05"});
  EXPECT_EQ(say(server_, "E0 00 20 01 00 00 00 00"), Answers{"80 00 00 00 01 00 04 05"});
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 01"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "41 00 20 01 00 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "33 00 20 01 61 62 63 64"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "40 00 20 01 00 00 00 00"), Answers{"41 00 20 01 09 00 00 00"});
  EXPECT_EQ(say(server_, "61 00 00 00 00 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "26 00 20 01 00 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "20 00 20 01 01 00 00 00"), Answers{"80 00 20 01 01 00 04 05"});
  EXPECT_EQ(say(server_, "40 00 20 07 00 00 00 00"), Answers{"80 00 20 07 11 00 09 06"});
  EXPECT_EQ(say(server_, "23 01 20 00 00 00 00 00"), Answers{"80 01 20 00 00 00 02 06"});
}

TEST_F(BlockServerSegmented, OtherFramesAreNotItsOwn) {
  const std::array<std::uint8_t, 8> read{0x40, 0x00, 0x20, 0x01};
  canopen::Frame request = canopen::make_frame(0x605, read);
  EXPECT_EQ(server_.answer(request).size(), 1U);
  EXPECT_TRUE(server_.answer(canopen::make_frame(0x606, read)).empty());
  EXPECT_TRUE(server_.answer(canopen::make_frame(0x585, read)).empty());
  EXPECT_TRUE(server_.answer(canopen::make_frame(0x605, std::span(read).first(7))).empty());
  for (bool canopen::Frame::* flag : {&canopen::Frame::extended, &canopen::Frame::remote, &canopen::Frame::error}) {
    canopen::Frame other = request;
    other.*flag = true;
    EXPECT_TRUE(server_.answer(other).empty());
  }
}

}  // namespace
}  // namespace support
