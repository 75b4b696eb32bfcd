#include "bridges/recorder/candump.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/recorder/record_bench.h"

namespace recorder {
namespace {

std::string line_of(const canopen::Frame& frame) {
  FrameRing ring(std::chrono::seconds(1), 1);
  ring.on_frame({frame, {}, wall_at(0) + std::chrono::microseconds(70)}, canopen::FrameOrigin::others);
  std::string line;
  ring.slice({}, canopen::TimePoint::max()).each([&](const KeptFrame& kept) { append_candump(line, "can0", kept); });
  return line;
}

TEST(Candump, WritesALineAsItsLogHasIt) {
  canopen::Frame frame;
  frame.id = 0x185;
  frame.size = 3;
  frame.data = {0x27, 0x02, 0xFF};
  EXPECT_EQ(line_of(frame), "(1767323045.000070) can0 185#2702FF\n");
}

TEST(Candump, WritesFramesWithoutDataAndWithAllOfIt) {
  canopen::Frame frame;
  frame.id = 0x80;
  EXPECT_EQ(line_of(frame), "(1767323045.000070) can0 080#\n");
  frame.size = 8;
  frame.data = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(line_of(frame), "(1767323045.000070) can0 080#0102030405060708\n");
}

TEST(Candump, TellsLongIdentifiersByTheirEightDigits) {
  canopen::Frame frame;
  frame.id = 0x123;
  frame.extended = true;
  EXPECT_EQ(line_of(frame), "(1767323045.000070) can0 00000123#\n");
}

TEST(Candump, WritesRemoteRequestsWithTheirLength) {
  canopen::Frame frame;
  frame.id = 0x705;
  frame.remote = true;
  EXPECT_EQ(line_of(frame), "(1767323045.000070) can0 705#R\n");
  frame.size = 1;
  EXPECT_EQ(line_of(frame), "(1767323045.000070) can0 705#R1\n");
}

// CAN_ERR_FLAG, as candump writes it.
TEST(Candump, MarksErrorFrames) {
  canopen::Frame frame;
  frame.id = 0x20;
  frame.size = 8;
  frame.error = true;
  EXPECT_EQ(line_of(frame), "(1767323045.000070) can0 20000020#0000000000000000\n");
}

TEST(Candump, HasNoLineForWhatWasLost) {
  FrameRing ring(std::chrono::seconds(1), 1);
  ring.on_frames_lost(7);
  std::string line;
  std::uint32_t lost = 0;
  ring.slice({}, canopen::TimePoint::max()).each([&](const KeptFrame& kept) {
    append_candump(line, "can0", kept);
    lost += kept.id;
  });
  EXPECT_EQ(line, "");
  EXPECT_EQ(lost, 7U);
}

}  // namespace
}  // namespace recorder
