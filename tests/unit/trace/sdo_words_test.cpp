#include <gmock/gmock.h>

#include <string>

#include "canopen/error.h"
#include "tests/unit/trace/site.h"

namespace trace {
namespace {

using test::Listener;
using testing::HasSubstr;

TEST(TraceSdo, ValuesOfSignalsAreInTheirUnits) {
  Listener bus;
  EXPECT_EQ(bus.words("605#4021200200000000"), "pump1 SDO: read 0x2021:02 output_frequency");
  EXPECT_EQ(bus.words("585#4B21200285130000"), "pump1 SDO: answer: 0x2021:02 output_frequency = 49.97 Hz");
  EXPECT_EQ(bus.words("585#4321200285130000"), "pump1 SDO: answer: 0x2021:02 output_frequency = 49.97 Hz")
      << "four bytes for two";
  EXPECT_EQ(bus.words("585#4221200285130000"), "pump1 SDO: answer: 0x2021:02 output_frequency = 49.97 Hz")
      << "without a size";
  EXPECT_EQ(bus.words("585#4F21200285000000"),
            "pump1 SDO: answer: 0x2021:02 output_frequency = 85, too short for its type");
}

TEST(TraceSdo, WhatCia301NamesIsNamed) {
  Listener bus;
  EXPECT_EQ(bus.words("605#2B171000F4010000"), "pump1 SDO: write 0x1017:00 producer heartbeat time = 500 ms");
  EXPECT_EQ(bus.words("585#6017100000000000"), "pump1 SDO: answer: 0x1017:00 producer heartbeat time written");
  EXPECT_EQ(bus.words("605#23161001E8037F00"),
            "pump1 SDO: write 0x1016:01 consumer heartbeat time = node 127 within 1000 ms");
  EXPECT_EQ(bus.words("605#2300180185010080"), "pump1 SDO: write 0x1800:01 TPDO1 COB-ID = 0x185, switched off");
  EXPECT_EQ(bus.words("605#2F001802FF000000"),
            "pump1 SDO: write 0x1800:02 TPDO1 transmission type = 255, on change or by its timer");
  EXPECT_EQ(bus.words("605#2F01140201000000"),
            "pump1 SDO: write 0x1401:02 RPDO2 transmission type = 1, with every SYNC");
  EXPECT_EQ(bus.words("605#23001A0110022120"),
            "pump1 SDO: write 0x1A00:01 TPDO1 mapping, object 1 = 0x2021:02, 16 bits");
  EXPECT_EQ(bus.words("585#4F01100005000000"),
            "pump1 SDO: answer: 0x1001:00 error register = 0x05, generic error, voltage");
  EXPECT_EQ(bus.words("585#4300100092010200"),
            "pump1 SDO: answer: 0x1000:00 device type = 0x00020192, device profile 402");
  EXPECT_EQ(bus.words("585#4318100192010200"), "pump1 SDO: answer: 0x1018:01 vendor id = 0x00020192");
  EXPECT_EQ(bus.words("585#4308100041423333"), "pump1 SDO: answer: 0x1008:00 device name = \"AB33\"");
}

// Every code of CiA 301 table 22, as canopen/error.h words it.
TEST(TraceSdo, AbortsAreWorded) {
  Listener bus;
  EXPECT_EQ(bus.words("585#8021200200000206"),
            "pump1 SDO: answer: 0x2021:02 output_frequency: abort 0x06020000, Object does not exist in the object "
            "dictionary");
  EXPECT_EQ(bus.words("605#8021200200000405"),
            "pump1 SDO: 0x2021:02 output_frequency: abort 0x05040000, SDO protocol timed out")
      << "by the client";
  EXPECT_THAT(bus.words("585#8021200278563412"), HasSubstr(": abort 0x12345678, unknown abort code"));
  EXPECT_EQ(bus.words("585#80212002"), "pump1 SDO: answer: not understood: 80 21 20 02");
}

TEST(TraceSdo, SegmentsBelongToTheTransferBeforeThem) {
  Listener bus;
  EXPECT_EQ(bus.words("605#4009100000000000"), "pump1 SDO: read 0x1009:00 hardware version");
  EXPECT_EQ(bus.words("585#410910000A000000"),
            "pump1 SDO: answer: 0x1009:00 hardware version: 10 bytes follow in segments");
  EXPECT_EQ(bus.words("605#6000000000000000"), "pump1 SDO: read 0x1009:00 hardware version: next segment asked for");
  EXPECT_EQ(bus.words("585#0041433331302D56"), "pump1 SDO: answer: 0x1009:00 hardware version: segment of 7 bytes");
  EXPECT_EQ(bus.words("605#7000000000000000"), "pump1 SDO: read 0x1009:00 hardware version: next segment asked for");
  EXPECT_EQ(bus.words("585#19312E3100000000"),
            "pump1 SDO: answer: 0x1009:00 hardware version: last segment, 10 bytes in all: \"AC310-V1.1\"");
  // Of another node meanwhile.
  EXPECT_EQ(bus.words("582#0041433331302D56"), "fan1 SDO: answer: an object that was not seen: segment of 7 bytes");
}

// Said twice: it counts once.
TEST(TraceSdo, ASegmentThatComesAgainIsNoPartOfTheValue) {
  Listener bus;
  (void)bus.words("605#4009100000000000");
  (void)bus.words("585#410910000A000000");
  (void)bus.words("605#6000000000000000");
  (void)bus.words("585#0041433331302D56");
  EXPECT_EQ(bus.words("585#0041433331302D56"), "pump1 SDO: answer: not understood: 00 41 43 33 31 30 2D 56");
  (void)bus.words("605#7000000000000000");
  EXPECT_EQ(bus.words("585#19312E3100000000"),
            "pump1 SDO: answer: 0x1009:00 hardware version: last segment, 10 bytes in all: \"AC310-V1.1\"");
  EXPECT_EQ(bus.words("585#19312E3100000000"), "pump1 SDO: answer: not understood: 19 31 2E 31 00 00 00 00");
  (void)bus.words("605#2110200108000000");
  (void)bus.words("605#0001020304050607");
  (void)bus.words("605#0001020304050607");
  EXPECT_EQ(bus.words("605#1D08000000000000"),
            "pump1 SDO: write 0x2010:01: last segment, 8 bytes in all: a value of 8 bytes: 01 02 03 04 05 06 07 08");
}

// As in a log of which a line is missing.
TEST(TraceSdo, OfAValueWithoutOneOfItsSegmentsNothingIsTold) {
  Listener bus;
  (void)bus.words("605#4009100000000000");
  (void)bus.words("585#4109100015000000");
  (void)bus.words("585#0041433331302D56");
  EXPECT_EQ(bus.words("585#0042433331302D56"), "pump1 SDO: answer: not understood: 00 42 43 33 31 30 2D 56");
  EXPECT_EQ(bus.words("585#1143433331302D56"),
            "pump1 SDO: answer: an object that was not seen: last segment of 7 bytes");
}

TEST(TraceSdo, WritesInSegments) {
  Listener bus;
  EXPECT_EQ(bus.words("605#2110200108000000"), "pump1 SDO: write 0x2010:01: 8 bytes follow in segments");
  EXPECT_EQ(bus.words("585#6010200100000000"), "pump1 SDO: answer: 0x2010:01 written");
  EXPECT_EQ(bus.words("605#0001020304050607"), "pump1 SDO: write 0x2010:01: segment of 7 bytes");
  EXPECT_EQ(bus.words("585#2000000000000000"), "pump1 SDO: answer: 0x2010:01: segment taken");
  EXPECT_EQ(bus.words("605#1D08000000000000"),
            "pump1 SDO: write 0x2010:01: last segment, 8 bytes in all: a value of 8 bytes: 01 02 03 04 05 06 07 08");
}

TEST(TraceSdo, OfALongValueOnlyTheLengthIsTold) {
  Listener bus;
  (void)bus.words("605#4010200200000000");
  (void)bus.words("585#4010200200000000");
  for (int i = 0; i < 9; ++i) {
    (void)bus.words(i % 2 == 0 ? "605#6000000000000000" : "605#7000000000000000");
    (void)bus.words(i % 2 == 0 ? "585#00FF020304050607" : "585#10FF020304050607");
  }
  EXPECT_EQ(bus.words("585#1D08000000000000"),
            "pump1 SDO: answer: 0x2010:02: last segment, 64 bytes in all: a value of 64 bytes");
}

TEST(TraceSdo, LostFramesEndWhatWasUnderWay) {
  Listener bus;
  (void)bus.words("605#4009100000000000");
  (void)bus.words("585#410910000A000000");
  (void)bus.decoder().lose(1, canopen::WallTime{});
  EXPECT_EQ(bus.words("585#0041433331302D56"), "pump1 SDO: answer: an object that was not seen: segment of 7 bytes");
}

// A block of which the first segments alone arrived: the rest comes again.
TEST(TraceSdo, SegmentsOfABlockThatComeAgainCountOnce) {
  Listener bus;
  (void)bus.words("605#A40810001F1C0000");
  (void)bus.words("585#C60810000F000000");
  (void)bus.words("605#A300000000000000");
  (void)bus.words("585#0141424344454647");
  (void)bus.words("585#0258585858585858");
  (void)bus.words("585#8358000000000000");
  EXPECT_EQ(bus.words("605#A2011F0000000000"), "pump1 SDO: 0x1008:00 device name: block taken up to segment 1");
  (void)bus.words("585#0148494A4B4C4D4E");
  (void)bus.words("585#824F000000000000");
  (void)bus.words("605#A2021F0000000000");
  EXPECT_EQ(bus.words("585#D900000000000000"),
            "pump1 SDO: answer: 0x1008:00 device name: end of block transfer, 15 bytes in all: \"ABCDEFGHIJKLMNO\"");
}

TEST(TraceSdo, WhatIsNoSdoIsShownAsItIs) {
  Listener bus;
  EXPECT_EQ(bus.words("605#"), "pump1 SDO: not understood: no data");
  EXPECT_EQ(bus.words("605#E000000000000000"), "pump1 SDO: not understood: E0 00 00 00 00 00 00 00");
  EXPECT_EQ(bus.words("585#4B21"), "pump1 SDO: answer: not understood: 4B 21");
  EXPECT_EQ(bus.words("609#4021200200000000"), "node 9 SDO: read 0x2021:02") << "nobody knows its objects";
}

}  // namespace
}  // namespace trace
