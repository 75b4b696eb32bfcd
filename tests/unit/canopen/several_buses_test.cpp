// Several buses of 126 drives each in one process: none delays another, and a power-up takes as many transfers a drive
// however many there are.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <vector>

#include "tests/support/hand_driven_loop.h"
#include "tests/unit/canopen/scale_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr std::uint32_t kBitrate = 1'000'000;
constexpr unsigned kFullBus = 126;

/// Of a power-up, until all drives are operational.
struct StartUp {
  Duration online_after{};
  std::vector<std::size_t> transfers;  ///< Of each bus.
  std::vector<std::size_t> frames;     ///< Likewise.
  std::size_t troubles = 0;            ///< Boot letters and losses.
};

class SeveralBuses : public testing::Test {
 protected:
  /// All drives of all buses get power at once.
  static StartUp power_up(unsigned buses, unsigned drives) {
    support::HandDrivenLoop loop;
    std::vector<std::unique_ptr<ScaleBench>> benches;
    for (unsigned bus = 0; bus < buses; ++bus) {
      ScaleBench& bench = *benches.emplace_back(std::make_unique<ScaleBench>(loop, kBitrate));
      for (unsigned node = 1; node <= drives; ++node) {
        bench.add(static_cast<std::uint8_t>(node));
      }
    }
    for (const auto& bench : benches) {
      for (const auto& member : bench->members()) {
        member->drive->switch_on();
      }
    }
    const TimePoint begun = Clock::now();
    const auto all_online = [&] {
      return std::ranges::all_of(benches, [](const auto& bench) { return bench->all_online(); });
    };
    while (!all_online() && Clock::now() < begun + 60s) {
      TimePoint next = kNever;
      for (const auto& bench : benches) {
        next = std::min(next, bench->act(begun + 60s));
      }
      const Duration time = next - Clock::now();
      loop.advance(time, time);
    }
    StartUp found;
    found.online_after = Clock::now() - begun;
    for (const auto& bench : benches) {
      std::size_t transfers = 0;
      for (const auto& member : bench->members()) {
        transfers += member->drive->requests();
      }
      found.transfers.push_back(transfers);
      found.frames.push_back(bench->ear().frames());
      found.troubles += bench->letters() + bench->losses();
    }
    return found;
  }
  static void print(unsigned buses, unsigned drives, const StartUp& found) {
    std::printf("%u x %3u drives: all online after %.3f s, %zu transfers and %zu frames on each bus\n", buses, drives,
                std::chrono::duration<double>(found.online_after).count(), found.transfers.front(),
                found.frames.front());
  }
};

TEST_F(SeveralBuses, EachPowersUpAsIfItWereAlone) {
  const StartUp alone = power_up(1, kFullBus);
  print(1, kFullBus, alone);
  EXPECT_EQ(alone.troubles, 0U);
  for (const unsigned buses : {2U, 4U}) {
    const StartUp together = power_up(buses, kFullBus);
    print(buses, kFullBus, together);
    EXPECT_EQ(together.online_after, alone.online_after);
    EXPECT_EQ(together.transfers, std::vector(buses, alone.transfers.front()));
    EXPECT_EQ(together.frames, std::vector(buses, alone.frames.front()));
    EXPECT_EQ(together.troubles, 0U);
  }
}

TEST_F(SeveralBuses, StartUpIsLinearInTheNumberOfDrives) {
  const StartUp few = power_up(1, kFullBus / 6);
  print(1, kFullBus / 6, few);
  for (const unsigned times : {2U, 3U, 6U}) {
    const StartUp many = power_up(1, times * kFullBus / 6);
    print(1, times * kFullBus / 6, many);
    EXPECT_EQ(many.transfers.front(), times * few.transfers.front());
    EXPECT_LE(many.online_after, times * few.online_after * 11 / 10);
    EXPECT_EQ(many.troubles, 0U);
  }
}

}  // namespace
}  // namespace canopen
