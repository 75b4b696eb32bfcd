#include "canopen/bus/bus_load.h"

#include <gtest/gtest.h>

#include "canopen/bus/error_share.h"
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

TEST(BusLoad, TheHighestIsThatOfTheBusiestSecond) {
  BusLoad load;
  const TimePoint start{1h};
  EXPECT_EQ(load.highest_per_mille(240000, start), 0);
  for (int i = 0; i < 500; ++i) {
    load.add({.size = 8}, start + i * 1ms);
  }
  EXPECT_EQ(load.highest_per_mille(240000, start + 450ms), 200) << "tenths that are over count";
  EXPECT_EQ(load.highest_per_mille(240000, start + 1s), 250);
  // A burst that nobody asked about, with silence before and behind it.
  for (int i = 0; i < 90; ++i) {
    load.add({.size = 8, .extended = true}, start + 1h + i * 1ms);
  }
  EXPECT_EQ(load.highest_per_mille(240000, start + 2h), 250) << "a lower one changes nothing";
  for (int i = 0; i < 1000; ++i) {
    load.add({.size = 8}, start + 3h + i * 100us);
  }
  EXPECT_EQ(load.highest_per_mille(240000, start + 4h), 500) << "of a tenth of a second that is long over";
  EXPECT_EQ(load.highest_per_mille(0, start + 4h), 0);
}

TEST(ErrorShare, CountsAmongTheNewestTenThousand) {
  ErrorShare share;
  EXPECT_EQ(share.count(), 0);
  share.add(true);
  share.add(true);
  for (int i = 0; i < 9998; ++i) {
    share.add(false);
  }
  EXPECT_EQ(share.count(), 2);
  share.add(false);
  EXPECT_EQ(share.count(), 1);
  share.add(false);
  EXPECT_EQ(share.count(), 0);
  for (int i = 0; i < 20'000; ++i) {
    share.add(true);
  }
  EXPECT_EQ(share.count(), 10'000);
}

}  // namespace
}  // namespace canopen
