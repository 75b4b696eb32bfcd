// Power-up of many drives on a bus with a bit rate: nothing is starved, nobody is declared lost or not bootable.

#include <gtest/gtest.h>

#include <cstdio>
#include <optional>
#include <ostream>
#include <string>

#include "tests/support/spawn.h"
#include "tests/unit/canopen/scale_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

// Heartbeat time: read, written, read back. Of a TPDO 8 objects are compared, 3 writes change its type, and COB-ID
// and type are read back; of the RPDO 6, 3 and 2. 0x1014 is read.
constexpr std::size_t kTransfersOfABoot = 3 + 3 * (8 + 3 + 2) + (6 + 3 + 2) + 1;

struct PowerUp {
  unsigned drives;
  std::uint32_t bitrate;
  std::uint16_t tpdo_event_timer;
  Duration online_within;
  bool bitrate_known = true;
};

double seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

std::ostream& operator<<(std::ostream& out, const PowerUp& power_up) {
  return out << power_up.drives << "DrivesAt" << power_up.bitrate << (power_up.tpdo_event_timer == 0 ? "" : "WithTpdos")
             << (power_up.bitrate_known ? "" : "NotTold");
}

class ScaleTest : public ::testing::TestWithParam<PowerUp> {};

TEST_P(ScaleTest, NobodyIsStarvedWhileAllBoot) {
  const PowerUp& power_up = GetParam();
  ScaleBench bench(power_up.bitrate, power_up.tpdo_event_timer, power_up.bitrate_known);
  for (unsigned node = 1; node <= power_up.drives; ++node) {
    bench.add(static_cast<std::uint8_t>(node));
  }
  for (const auto& member : bench.members()) {
    member->drive->switch_on();
  }
  const TimePoint begun = Clock::now();
  EXPECT_TRUE(bench.run_until([&] { return bench.all_online(); }, 120s));
  const Duration online_after = Clock::now() - begun;
  const double load = static_cast<double>(bench.ear().bits()) / seconds(online_after) / power_up.bitrate;
  bench.run_for(2s);  // With all TPDOs.
  const Duration own_gap = bench.ear().longest_gap(ScaleBench::kOwnNode);
  std::printf(
      "%3u drives at %7u bit/s, TPDOs each %u ms: all online after %5.2f s, longest gap of our heartbeat %.2f s, "
      "letters %zu (%s), lost %zu, requests to a drive %zu, load %.2f\n",
      power_up.drives, power_up.bitrate, power_up.tpdo_event_timer, seconds(online_after), seconds(own_gap),
      bench.letters(), bench.a_letter().c_str(), bench.losses(), bench.members().front()->drive->requests(), load);
  EXPECT_LE(online_after, power_up.online_within);
  EXPECT_LE(own_gap, 700ms);
  EXPECT_EQ(bench.letters(), 0U) << bench.a_letter();
  EXPECT_EQ(bench.losses(), 0U);
  EXPECT_EQ(bench.members().front()->drive->requests(), kTransfersOfABoot);
}

INSTANTIATE_TEST_SUITE_P(PowerUp, ScaleTest,
                         ::testing::Values(PowerUp{16, 125000, 0, 4s}, PowerUp{24, 125000, 0, 5s},
                                           PowerUp{32, 125000, 0, 6s}, PowerUp{64, 250000, 0, 7s},
                                           PowerUp{64, 500000, 0, 4s}, PowerUp{126, 500000, 0, 6s},
                                           PowerUp{126, 1000000, 0, 3500ms}, PowerUp{126, 125000, 0, 30s},
                                           PowerUp{32, 50000, 0, 20s}, PowerUp{16, 125000, 100, 8s},
                                           PowerUp{32, 125000, 0, 6s, false}),
                         ::testing::PrintToStringParamName());

TEST(RunningDrives, AreNotLostAndStopWhileOthersPowerUp) {
  ScaleBench bench(125000);
  for (std::uint8_t node = 123; node <= 126; ++node) {
    bench.add(node).drive->run();
  }
  ASSERT_TRUE(bench.run_until([&] { return bench.all_online(); }, 10s));
  for (std::uint8_t node = 1; node <= 32; ++node) {
    bench.add(node);
  }
  bench.run_for(2500ms);
  const std::size_t lost_before = bench.losses();  // Those that are off.
  for (std::size_t i = 4; i < bench.members().size(); ++i) {
    bench.members()[i]->drive->switch_on();
  }
  const TimePoint begun = Clock::now();
  std::size_t stops = 0;
  std::size_t confirmed = 0;
  Duration slowest{};
  while (!bench.all_online() && Clock::now() < begun + 60s) {
    RemoteNode& node = *bench.members()[stops % 4]->node;
    const TimePoint asked = Clock::now();
    const auto stop =
        support::spawn(bench.executor(), node.write({0x2030, 2}, DataType::u16, 5 + stops, asked + 800ms));
    static_cast<void>(bench.run_until([&] { return stop.done(); }, 900ms));
    ++stops;
    if (stop.done() && stop.get().has_value()) {
      ++confirmed;
      slowest = std::max(slowest, Clock::now() - asked);
    }
    bench.run_for(200ms);
  }
  std::printf(
      " 32 drives beside 4 running at 125000 bit/s: all online after %5.2f s, longest gap of our heartbeat %.2f "
      "s, letters %zu (%s), lost %zu, stops %zu, confirmed %zu, the slowest after %.0f ms\n",
      seconds(Clock::now() - begun), seconds(bench.ear().longest_gap(ScaleBench::kOwnNode)), bench.letters(),
      bench.a_letter().c_str(), bench.losses() - lost_before, stops, confirmed, seconds(slowest) * 1000);
  EXPECT_GE(stops, 10U);
  EXPECT_EQ(confirmed, stops);
  EXPECT_EQ(bench.losses(), lost_before);
  EXPECT_EQ(bench.letters(), 0U) << bench.a_letter();
}

}  // namespace
}  // namespace canopen
