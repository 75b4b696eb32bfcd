// Block transfer where CAN delivers a frame of the server twice: ISO 11898-1 allows it after an error at its end.

#include <gtest/gtest.h>

#include <cstdint>
#include <tuple>
#include <vector>

#include "tests/unit/canopen/sdo_fault_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

SdoSettings with_block() {
  SdoSettings settings;
  settings.block = true;
  return settings;
}

/// Segments of a sub-block of the server, and bits per second.
class SdoBlockDoubledTest : public testing::TestWithParam<std::tuple<std::uint8_t, unsigned>> {};

// 33 bytes: five segments, so that one is left behind a sub-block of four.
TEST_P(SdoBlockDoubledTest, WhicheverFrameOfADownloadItIsAllIsTakenOnce) {
  std::size_t frames = 1;
  for (std::size_t at = 0; at < frames; ++at) {
    SCOPED_TRACE(at);
    SdoFaultBench bench(with_block(), std::get<1>(GetParam()));
    const SdoFaultBench::Bytes data = SdoFaultBench::counted(33);
    bench.node.server.objects[SdoFaultBench::kFile] = {1};
    bench.node.server.faults.block_sizes = {std::get<0>(GetParam())};
    bench.node.fault = WireFault::doubled;
    bench.node.at = at;
    const auto writing = bench.command(SdoFaultBench::kFile, data);
    ASSERT_TRUE(bench.loop.advance_until([&] { return writing.done(); }, 1s));
    ASSERT_TRUE(writing.get().has_value()) << to_string(writing.get().error());
    EXPECT_EQ(bench.node.server.objects[SdoFaultBench::kFile], data);
    EXPECT_TRUE(bench.node.server.aborts_heard().empty());
    frames = bench.node.frames;
  }
  EXPECT_GE(frames, 3U);
}

INSTANTIATE_TEST_SUITE_P(Servers, SdoBlockDoubledTest,
                         testing::Combine(testing::Values(std::uint8_t{1}, std::uint8_t{2}, std::uint8_t{4},
                                                          std::uint8_t{5}, std::uint8_t{127}),
                                          testing::Values(125'000U, 1'000'000U)));

}  // namespace
}  // namespace canopen
