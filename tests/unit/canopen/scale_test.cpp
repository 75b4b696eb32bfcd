// Power-up of many drives on a bus with a bit rate: nothing is starved, nobody is declared lost or not bootable.

#include <gtest/gtest.h>

#include <cstdio>

#include "tests/unit/canopen/scale_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

struct PowerUp {
  unsigned drives;
  std::uint32_t bitrate;
  std::uint16_t tpdo_event_timer;
  Duration online_within;
};

double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

void PrintTo(const PowerUp& power_up, std::ostream* out) {
  *out << power_up.drives << " drives at " << power_up.bitrate << " bit/s";
}

class ScaleTest : public ::testing::TestWithParam<PowerUp> {};

TEST_P(ScaleTest, NobodyIsStarvedWhileAllBoot) {
  const PowerUp& power_up = GetParam();
  ScaleBench bench(power_up.bitrate, power_up.tpdo_event_timer);
  for (unsigned node = 1; node <= power_up.drives; ++node) {
    bench.add(static_cast<std::uint8_t>(node));
  }
  for (const auto& member : bench.members()) {
    member->drive->switch_on();
  }
  const TimePoint begun = Clock::now();
  EXPECT_TRUE(bench.run_until([&] { return bench.all_online(); }, 120s));
  const Duration online_after = Clock::now() - begun;
  const Duration own_gap = bench.ear().longest_gap(ScaleBench::kOwnNode);
  std::printf(
      "%3u drives at %7u bit/s, TPDOs each %u ms: all online after %5.2f s, longest gap of our heartbeat %.2f s, "
      "letters %zu (%s), lost %zu, requests to a drive %zu, load %.2f\n",
      power_up.drives, power_up.bitrate, power_up.tpdo_event_timer, seconds(online_after), seconds(own_gap),
      bench.letters(), bench.a_letter().c_str(), bench.losses(), bench.members().front()->drive->requests(),
      static_cast<double>(bench.ear().bits()) / seconds(online_after) / power_up.bitrate);
  EXPECT_LE(online_after, power_up.online_within);
  EXPECT_LE(own_gap, 700ms);
  EXPECT_EQ(bench.letters(), 0U) << bench.a_letter();
  EXPECT_EQ(bench.losses(), 0U);
}

INSTANTIATE_TEST_SUITE_P(PowerUp, ScaleTest,
                         ::testing::Values(PowerUp{16, 125000, 0, 4s}, PowerUp{16, 125000, 100, 8s}));

}  // namespace
}  // namespace canopen
