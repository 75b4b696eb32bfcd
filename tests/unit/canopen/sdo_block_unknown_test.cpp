// When a node counts as one that does not know block transfer, because it does not answer to it.

#include <gtest/gtest.h>

#include <cstdint>

#include "tests/unit/canopen/sdo_fault_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SdoBlockUnknownTest : public testing::Test {
 protected:
  static SdoSettings with_block() {
    SdoSettings settings;
    settings.block = true;
    return settings;
  }
  void read() {
    const auto reading = bench_.read(SdoFaultBench::kFile);
    ASSERT_TRUE(bench_.loop.advance_until([&] { return reading.done(); }, 5s));
    ASSERT_TRUE(reading.get().has_value()) << to_string(reading.get().error());
    EXPECT_EQ(reading.get().value(), data_);
  }
  /// The request for block transfer is lost, as where the node does not know it. `before`: so many others go before it.
  void read_with_silence(std::size_t before = 0) {
    bench_.node.fault = WireFault::request_lost;
    bench_.node.at = bench_.node.requests.size() + before;
    read();
    bench_.node.fault = WireFault::none;
  }
  [[nodiscard]] std::size_t begun_by_block() const { return bench_.begun_with(0xA4); }

  SdoFaultBench bench_{with_block()};
  const SdoFaultBench::Bytes data_ = SdoFaultBench::counted(100);
  void SetUp() override { bench_.node.server.objects[SdoFaultBench::kFile] = data_; }
};

TEST_F(SdoBlockUnknownTest, OneLostRequestIsReadInSegmentsAndSaysNothing) {
  read_with_silence();
  EXPECT_EQ(bench_.begun_with(0x40), 1U);
  EXPECT_TRUE(bench_.remarks.empty());
  read();
  EXPECT_EQ(begun_by_block(), 2U);
}

TEST_F(SdoBlockUnknownTest, ANodeThatIsSilentTwiceIsAskedInSegments) {
  read_with_silence();
  read_with_silence(1);  // Behind the proof that the one before is over.
  EXPECT_EQ(bench_.remarks.size(), 1U);
  read();
  EXPECT_EQ(begun_by_block(), 2U);
  bench_.client->interrupt();  // It may have got another firmware.
  bench_.loop.advance(1ms);
  read();
  EXPECT_EQ(begun_by_block(), 3U);
}

TEST_F(SdoBlockUnknownTest, OneThatAnswersBetweenKnowsIt) {
  read_with_silence();
  read();
  read_with_silence();
  EXPECT_TRUE(bench_.remarks.empty());
  read();
  EXPECT_EQ(begun_by_block(), 4U);
}

TEST_F(SdoBlockUnknownTest, AnotherClientsRequestIsNoSilence) {
  bench_.node.fault = WireFault::foreign_client;
  for (int i = 0; i < 3; ++i) {
    bench_.node.at = bench_.node.frames;
    bench_.node.foreign_sent = false;
    read();
    EXPECT_TRUE(bench_.node.foreign_sent);
  }
  EXPECT_TRUE(bench_.remarks.empty());
  EXPECT_EQ(begun_by_block(), 6U) << "and it is asked by block again";
}

}  // namespace
}  // namespace canopen
