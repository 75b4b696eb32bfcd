#include "canopen/bus/bit_timing.h"

#include <gtest/gtest.h>

#include "tests/support/bus_fixture.h"

namespace canopen {
namespace {

constexpr BitTiming kGood{.bitrate = 250'000, .sample_point = 875, .restart_ms = 100};

TEST(BitTiming, IsToldInTheWordsOfIp) {
  EXPECT_EQ(describe(kGood), "250000 bit/s, sample point 87.5 %, restart-ms 100");
}

TEST(BitTiming, NothingIsDoubtedOfAGoodOne) {
  EXPECT_TRUE(doubts_about(kGood, {}).empty());
  EXPECT_TRUE(doubts_about(kGood, 250'000).empty());
  EXPECT_TRUE(doubts_about({.bitrate = 250'000, .sample_point = 0, .restart_ms = 1}, {}).empty())
      << "not every driver tells a sample point";
}

TEST(BitTiming, EachDoubtNamesItsRemedy) {
  const std::vector<std::string> doubts =
      doubts_about({.bitrate = 125'000, .sample_point = 500, .restart_ms = 0}, 250'000);
  ASSERT_EQ(doubts.size(), 3U);
  EXPECT_EQ(doubts[0],
            "the interface runs at 125000 bit/s, `bitrate` says 250000: the interface's is used; put the wrong one "
            "right");
  EXPECT_NE(doubts[1].find("sample-point 0.875"), std::string::npos);
  EXPECT_NE(doubts[2].find("restart-ms 100"), std::string::npos);
}

class ToldTimingTest : public testing::Test {
 protected:
  support::HandDrivenLoop loop_;
  LinkEvents* link_ = nullptr;
};

TEST_F(ToldTimingTest, TheInterfacesBitRateIsUsed) {
  Bus bus(loop_.executor(), std::make_unique<support::HandLink>(link_), {.bitrate = 1'000'000, .node_id = 0});
  BitTiming told;
  const Subscription subscription = bus.subscribe_timing([&](const BitTiming& timing) { told = timing; });
  bus.start();
  EXPECT_EQ(bus.bitrate(), 1'000'000U);
  const std::size_t most = bus.sdo_budget().most_at_once();
  link_->on_bit_timing(kGood);
  EXPECT_EQ(told, kGood);
  EXPECT_EQ(bus.bitrate(), 250'000U);
  EXPECT_EQ(bus.statistics().bitrate, 250'000U);
  EXPECT_LT(bus.sdo_budget().most_at_once(), most);
  link_->on_bus_state({.condition = BusCondition::error_active});
  const TimePoint start = Clock::now();
  std::vector<Received> heard;
  for (int i = 0; i < 1000; ++i) {
    heard.push_back({.frame = {.id = 0x185, .size = 8}, .at = start, .wall = {}});
  }
  link_->on_frames(heard);
  loop_.advance(std::chrono::milliseconds(150), std::chrono::milliseconds(10));
  EXPECT_EQ(bus.statistics().load_per_mille, 480U) << "1 000 frames of 120 bits in a second at 250 kbit/s";
}

}  // namespace
}  // namespace canopen
