// When a boot or takeover that ended with a letter is tried again: later each time for the same cause.

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "canopen/node/retry_pause.h"
#include "tests/unit/canopen/node_life_bench.h"
#include "tests/unit/canopen/scale_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

TEST(RetryPause, GrowsForTheSameCauseUpToAMinute) {
  RetryPause retry;
  for (const Duration pause : {5s, 10s, 20s, 40s, 60s, 60s}) {
    EXPECT_EQ(retry.after(BootResult::not_configured, "0x1017:00"), pause);
  }
}

TEST(RetryPause, AnotherCauseBeginsAnew) {
  RetryPause retry;
  EXPECT_EQ(retry.after(BootResult::not_configured, "0x1017:00"), 5s);
  EXPECT_EQ(retry.after(BootResult::not_configured, "0x1017:00"), 10s);
  EXPECT_EQ(retry.after(BootResult::not_configured, "0x1A00:01"), 5s);
  EXPECT_EQ(retry.after(BootResult::no_answer, "0x1A00:01"), 5s);
  EXPECT_EQ(retry.after(BootResult::no_answer, "0x1A00:01"), 10s);
  retry.begin_anew();
  EXPECT_EQ(retry.after(BootResult::no_answer, "0x1A00:01"), 5s);
}

class BootRetryTest : public NodeLifeBench {
 protected:
  BootRetryTest() {
    install(settings_);
    slave_.set(kHeartbeatTime, DataType::u16, 1000);
    slave_.refuse_write(kHeartbeatTime, 0x08000000);
  }
  void boot_in_vain() {
    start(settings_);
    slave_.boot_up();
    loop_.advance(100ms);
    ASSERT_EQ(status().boot_result, BootResult::not_configured) << status().boot_text;
    slave_.forget_heard();
  }
  /// How long until the drive is asked again.
  Duration next_try() {
    const TimePoint from = Clock::now();
    EXPECT_TRUE(loop_.advance_until([this] { return !slave_.reads().empty(); }, 100s));
    const Duration waited = Clock::now() - from;
    loop_.advance(100ms);
    slave_.forget_heard();
    return waited;
  }
  static void expect_about(Duration waited, Duration expected) {
    EXPECT_GE(waited, expected - 200ms);
    EXPECT_LE(waited, expected + 200ms);
  }

  NodeSettings settings_ = bench_settings();
};

TEST_F(BootRetryTest, EachPauseIsTwiceTheOneBefore) {
  boot_in_vain();
  for (const Duration pause : {5s, 10s, 20s, 40s, 60s, 60s}) {
    expect_about(next_try(), pause);
  }
}

TEST_F(BootRetryTest, ABootUpAndAnNmtStartBeginAtOnceAndAnew) {
  boot_in_vain();
  expect_about(next_try(), 5s);
  expect_about(next_try(), 10s);
  slave_.boot_up();
  expect_about(next_try(), 0s);
  expect_about(next_try(), 5s);
  expect_about(next_try(), 10s);
  const auto started = command(NmtCommand::start);
  expect_about(next_try(), 0s);
  ASSERT_TRUE(started.done());
  EXPECT_EQ(started.get().error().kind, ErrorKind::refused);
  expect_about(next_try(), 5s);
}

TEST_F(BootRetryTest, AnotherCauseIsTriedAgainSoon) {
  boot_in_vain();
  expect_about(next_try(), 5s);
  expect_about(next_try(), 10s);
  slave_.set(kHeartbeatTime, DataType::u16, 500);  // That is put right, and the next mistake shows.
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  slave_.ignore_write(kMapping);
  expect_about(next_try(), 20s);
  expect_about(next_try(), 5s);
}

// No boot-up is heard, for it never was away: only its heartbeat is too slow.
TEST_F(BootRetryTest, AHeartbeatThatIsTooSlowIsNoNewCause) {
  slave_.set(kHeartbeatTime, DataType::u16, 2000);
  boot_in_vain();
  loop_.advance(100s, 5ms);
  EXPECT_GT(status().heartbeat_losses, 10U);
  slave_.forget_heard();
  loop_.advance(60s, 5ms);
  const std::vector<ObjectAddress> writes = slave_.writes();
  EXPECT_LE(writes.size(), 1U) << "one try in a minute";
}

// It was switched off and on, with its mistake corrected, and nobody heard its boot-up message.
TEST_F(BootRetryTest, OneThatWasLostAndComesBackIsBootedAtOnce) {
  boot_in_vain();
  for (const Duration pause : {5s, 10s, 20s}) {
    expect_about(next_try(), pause);
  }
  slave_.unplug(true);
  loop_.advance(1800ms);
  ASSERT_TRUE(status().lost);
  slave_.set(kHeartbeatTime, DataType::u16, 500);
  slave_.unplug(false);
  EXPECT_TRUE(wait_online(3s)) << status().boot_text;
}

TEST_F(BootRetryTest, OnceAnErrorIsGoneAStartIsTriedSoon) {
  slave_.set(kHeartbeatTime, DataType::u16, 500);
  slave_.set({0x1001, 0}, DataType::u8, 0x01);
  slave_.ignore_nmt(true);
  start(settings_);
  slave_.boot_up();
  loop_.advance(100s, 5ms);
  ASSERT_EQ(status().held_back, HeldBack::start_ignored) << status().boot_text;
  slave_.forget_heard();
  ASSERT_TRUE(loop_.advance_until([this] { return starts() == 1; }, 70s));
  loop_.advance(5s);  // Far from the next try.
  slave_.forget_heard();
  slave_.send(0x085, {0, 0, 1, 0, 0, 0, 0, 0});  // An error is gone, another one is left.
  loop_.advance(10s);
  EXPECT_EQ(starts(), 0);
  slave_.ignore_nmt(false);
  slave_.send(0x085, {0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_TRUE(wait_online(5500ms)) << status().boot_text;
}

// One mistake in a profile, or one weakness of a drive, 126 times on a bus.
class ManyDrives : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kBitrate = 125000;

  void add_all() {
    for (std::uint8_t node = 1; node <= 126; ++node) {
      bench_.add(node);
    }
  }
  /// The load of the bus by all traffic in the next `time`.
  double load_in(Duration time) {
    const std::uint64_t before = bench_.ear().bits();
    bench_.run_for(time);
    return static_cast<double>(bench_.ear().bits() - before) / std::chrono::duration<double>(time).count() / kBitrate;
  }
  [[nodiscard]] Duration own_gap() const { return bench_.ear().longest_gap(ScaleBench::kOwnNode); }
  void print(const char* what, double load) const {
    std::printf("126 drives that %s at 125 kbit/s: load %.2f, longest gap of our heartbeat %.2f s, lost %zu\n", what,
                load, std::chrono::duration<double>(own_gap()).count(), bench_.losses());
  }

  ScaleBench bench_{kBitrate};
};

TEST_F(ManyDrives, WithOneMistakeLeaveTheBusToOthers) {
  add_all();
  for (const auto& member : bench_.members()) {
    member->drive->keep({0x1400, 2});
    member->drive->switch_on();
  }
  bench_.run_for(40s);
  EXPECT_EQ(bench_.letters(), 126U) << bench_.a_letter();
  const double load = load_in(60s);
  print("keep a setting", load);
  EXPECT_LE(load, 0.5);
  EXPECT_LE(own_gap(), 700ms);
  EXPECT_EQ(bench_.losses(), 0U);
}

TEST_F(ManyDrives, WhoseSdoServersSleepAreNoStorm) {
  bench_.set_patience(10s);
  add_all();
  for (const auto& member : bench_.members()) {
    member->drive->sleep_until(Clock::now() + 8s);
    member->drive->switch_on();
  }
  const double load = load_in(8s);
  print("do not answer", load);
  EXPECT_LE(load, 0.3);
  ASSERT_TRUE(bench_.run_until([this] { return bench_.all_online(); }, 40s));
  EXPECT_EQ(bench_.letters(), 0U) << bench_.a_letter();
  EXPECT_EQ(bench_.losses(), 0U);
  EXPECT_LE(own_gap(), 700ms);
}

}  // namespace
}  // namespace canopen
