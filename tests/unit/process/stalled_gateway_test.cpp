// The gateway was not scheduled for a while, and the drive's frames wait with their receive times.

#include <gtest/gtest.h>

#include "tests/unit/process/drive_bench.h"

namespace process {
namespace {

using namespace std::chrono_literals;

using StalledGatewayTest = DriveBench;

TEST_F(StalledGatewayTest, TakesWhatWaitsUnreadForNoSilence) {
  bring_online();
  run_motor();
  run(100ms);
  observer_.stale.clear();
  link_.stall();
  run(1450ms);
  EXPECT_FALSE(fresh("running")) << "nobody may take it for a value of now";
  link_.resume();
  loop_.settle();
  EXPECT_TRUE(fresh("running"));
  run(10ms);
  EXPECT_TRUE(observer_.stale.empty()) << "what waited unread was taken for silence";
  EXPECT_FALSE(alarm(alarms::AlarmKind::data).active);
  EXPECT_TRUE(write_now({field("frequency_command", 20.0)}).has_value()) << "a standstill was made of it";
}

// A system call is dear on some machines, and frames come by the thousand.
TEST_F(StalledGatewayTest, NoFrameReadsAClock) {
  bring_online();
  link_.stall();
  for (int i = 0; i < 50; ++i) {
    send_tpdos();
  }
  ASSERT_GE(link_.waiting(), 100U);
  ASSERT_LE(link_.waiting(), link_.kBatch);
  observer_.values.clear();
  const std::uint64_t before = canopen::ManualTime::readings();
  link_.resume();
  loop_.settle();
  EXPECT_EQ(observer_.values.size(), 100U);
  EXPECT_LE(canopen::ManualTime::readings() - before, 10U) << "for the whole batch";
}

}  // namespace
}  // namespace process
