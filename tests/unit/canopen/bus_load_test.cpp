#include "canopen/bus/bus_load.h"

#include <gtest/gtest.h>

#include "canopen/bus/wire_bits.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

TEST(BusLoad, BitsOfAFrame) {
  EXPECT_EQ(bits_on_wire({.size = 0}), 47U + 3U);
  EXPECT_EQ(bits_on_wire({.size = 8}), 111U + 9U);
  EXPECT_EQ(bits_on_wire({.size = 8, .extended = true}), 131U + 11U);
  EXPECT_EQ(bits_on_wire({.size = 8, .remote = true}), 47U + 3U) << "a remote request carries no data";
}

TEST(BusLoad, BitsOfAFrameAtWorst) {
  // 3 703 frames of 8 bytes a second at 500 kbit/s.
  EXPECT_EQ(wire_bits(8, Stuffing::worst), 135U);
  EXPECT_EQ(wire_bits(8, Stuffing::worst, true), 160U);
  EXPECT_EQ(wire_bits(0, Stuffing::worst), 55U);
}

TEST(BusLoad, AFullBusIsNeverMoreThanFull) {
  BusLoad load;
  const TimePoint start{1h};
  for (int i = 0; i < 3000; ++i) {
    load.add({.size = 8}, start + i * 1ms);
  }
  EXPECT_EQ(load.per_mille(120000, start + 3s), 1000);
  EXPECT_EQ(load.per_mille(1000000, start + 3s), 120);
  EXPECT_EQ(load.per_mille(10000, start + 3s), 1000);
  EXPECT_EQ(load.per_mille(0, start + 3s), 0);
}

TEST(BusLoad, FadesWithinASecondAndSurvivesAPause) {
  BusLoad load;
  const TimePoint start{1h};
  for (int i = 0; i < 1000; ++i) {
    load.add({.size = 8}, start + i * 1ms);
  }
  EXPECT_EQ(load.per_mille(240000, start + 1s), 500);
  EXPECT_EQ(load.per_mille(240000, start + 1500ms), 250);
  EXPECT_EQ(load.per_mille(240000, start + 2s), 0);
  EXPECT_EQ(load.per_mille(240000, start + 100h), 0);
}

}  // namespace
}  // namespace canopen
