#include "bridges/trace/candump.h"

#include <gmock/gmock.h>

#include <string>

namespace trace {
namespace {

using testing::HasSubstr;

std::string again(const std::string& line) {
  const auto read = parse_candump_line(line);
  const auto* const logged = std::get_if<LoggedFrame>(&read);
  return logged == nullptr ? "no frame: " + std::get<NoFrame>(read).why
                           : candump_line(logged->at, logged->interface, logged->frame);
}

TEST(Candump, ALineIsReadAsItIsWritten) {
  for (const std::string line :
       {"(1767323045.678123) can0 185#0102030405060708", "(0000000000.000000) vcan12 000#8100",
        "(1767323045.000001) can0 080#", "(1767323045.000001) can0 18FEF100#AA", "(1767323045.000001) can0 705#R",
        "(1767323045.000001) can0 705#R8", "(1767323045.000001) can0 20000204#0004000000006000"}) {
    EXPECT_EQ(again(line), line == "(0000000000.000000) vcan12 000#8100" ? "(0.000000) vcan12 000#8100" : line);
  }
}

TEST(Candump, KindsOfFramesAndWhoSentThem) {
  const auto error = std::get<LoggedFrame>(parse_candump_line("(1.000000) can0 20000040#"));
  EXPECT_TRUE(error.frame.error);
  EXPECT_EQ(error.frame.id, 0x40U);
  EXPECT_EQ(error.origin, canopen::FrameOrigin::driver);
  const auto extended = std::get<LoggedFrame>(parse_candump_line("(1.000000) can0 00000185#01"));
  EXPECT_TRUE(extended.frame.extended);
  EXPECT_EQ(std::get<LoggedFrame>(parse_candump_line("(1.000000) can0 185#01 T")).origin,
            canopen::FrameOrigin::ourselves);
  EXPECT_EQ(std::get<LoggedFrame>(parse_candump_line("(1.000000) can0 185#01 R")).origin, canopen::FrameOrigin::others);
  EXPECT_EQ(std::get<LoggedFrame>(parse_candump_line("(1.000000) can0 185#01.0A.FF")).frame.size, 3);
}

TEST(Candump, WhatIsNoneSaysWhy) {
  EXPECT_THAT(again("  can0  185   [2]  01 02"), HasSubstr("does not begin with a time"));
  EXPECT_THAT(again("(1767323045.6781) can0 185#"), HasSubstr("does not begin with a time"));
  EXPECT_THAT(again("(-1.000000) can0 185#"), HasSubstr("does not begin with a time"));
  EXPECT_THAT(again("(99999999999999999999.000000) can0 185#"), HasSubstr("does not begin with a time"));
  EXPECT_THAT(again("(1.000000)"), HasSubstr("interface is missing"));
  EXPECT_THAT(again("(1.000000) can0"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 185"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 1852#"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 800#"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 185#1"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 185#-1"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 185#010203040506070809"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 185#R9"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 FFFFFFFF#"), HasSubstr("no frame"));
  EXPECT_THAT(again("(1.000000) can0 185##101"), HasSubstr("CAN FD"));
  EXPECT_THAT(again("(1.000000) can0 185#01 X"), HasSubstr("behind the frame"));
  EXPECT_THAT(again(std::string(kMaxLogLine + 1, 'x')), HasSubstr("longer"));
  EXPECT_THAT(again(""), HasSubstr("no frame: "));
}

}  // namespace
}  // namespace trace
