// As root: tests/vcan/run BUILD/tests/vcan/socketcan_link_test
// The process stands still while its drives go on: receive times, and who is taken for silent afterwards.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/node/heartbeat_consumer.h"
#include "tests/vcan/link_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::OtherSocket;
using support::WithoutNetAdmin;

constexpr std::uint8_t kDrives = 20;
constexpr std::uint8_t kMute = kDrives + 1;  ///< Another one, that falls silent.
constexpr Duration kTpdoPeriod = 2ms;        ///< 500 a second of all drives.

/// The drives: heartbeats every 500 ms, and TPDOs that carry the moment they were sent.
class Drives {
 public:
  Drives() : thread_([this] { run(); }) {}
  ~Drives() {
    stop();
    thread_.join();
  }
  Drives(const Drives&) = delete;
  Drives& operator=(const Drives&) = delete;

  void mute() { muted_ = true; }
  void stop() { stop_ = true; }
  [[nodiscard]] std::size_t sent() const { return sent_; }

 private:
  void run() {
    OtherSocket socket("vcan0");
    auto next = Clock::now();
    auto next_heartbeat = next;
    while (!stop_) {
      if (Clock::now() >= next_heartbeat) {
        next_heartbeat += 500ms;
        for (std::uint8_t node = 1; node <= (muted_ ? kDrives : kMute); ++node) {
          socket.send(0x700U + node, {5});
          ++sent_;
        }
      }
      const std::int64_t now = Clock::now().time_since_epoch().count();
      std::vector<std::uint8_t> bytes(sizeof now);
      std::memcpy(bytes.data(), &now, sizeof now);
      socket.send(0x181, bytes);
      ++sent_;
      next += kTpdoPeriod;
      std::this_thread::sleep_until(std::chrono::steady_clock::time_point(next.time_since_epoch()));
    }
  }

  std::atomic<bool> stop_ = false;
  std::atomic<bool> muted_ = false;
  std::atomic<std::size_t> sent_ = 0;
  std::thread thread_;
};

class LinkStallTest : public support::LinkFixture {
 protected:
  void start() {
    BusSettings settings;
    settings.heartbeat = Duration::zero();
    bus = std::make_unique<Bus>(context.get_executor(), make_socketcan_link(context.get_executor(), "vcan0"), settings);
    lost_at.resize(kMute + 1U);
    for (std::uint8_t node = 1; node <= kMute; ++node) {
      watches.push_back(std::make_unique<HeartbeatConsumer>(
          context.get_executor(), 1500ms, [this, node] { lost_at[node] = Clock::now(); },
          [this](TimePoint until) { return bus->may_still_hear(until); }));
      subscriptions.push_back(
          bus->subscribe(0x700U + node, [this, watch = watches.back().get()](const Received& received) {
            ++received_frames;
            watch->alive(received.at);
          }));
      watches.back()->watch(Clock::now());
    }
    subscriptions.push_back(bus->subscribe(0x181, [this](const Received& received) {
      ++received_frames;
      std::int64_t sent = 0;
      std::memcpy(&sent, received.frame.data.data(), sizeof sent);
      const Duration late = received.at - TimePoint(Duration(sent));
      latest = std::max(latest, late);
      earliest = std::min(earliest, late);
      oldest = std::max(oldest, Clock::now() - received.at);
    }));
    subscriptions.push_back(bus->subscribe_losses([this](std::uint32_t count) {
      lost += count;
      for (const auto& watch : watches) {
        watch->frames_lost(Clock::now());
      }
    }));
    bus->start();
    ASSERT_TRUE(run_until([this] { return bus->state().up(); }));
  }
  void TearDown() override {
    subscriptions.clear();
    watches.clear();
    bus.reset();
  }
  static void stand_still(Duration time) { std::this_thread::sleep_for(time); }
  /// How many of the drives that go on sending were taken for silent.
  [[nodiscard]] std::ptrdiff_t falsely_lost() const {
    return std::count_if(lost_at.begin(), lost_at.begin() + kMute, [](const auto& at) { return at.has_value(); });
  }

  std::unique_ptr<Bus> bus;
  std::vector<std::unique_ptr<HeartbeatConsumer>> watches;
  std::vector<Subscription> subscriptions;
  std::vector<std::optional<TimePoint>> lost_at;  ///< By node id.
  std::size_t received_frames = 0;
  std::uint32_t lost = 0;
  Duration latest{};    ///< Receive time after sending.
  Duration earliest{};  ///< Negative: received before it was sent.
  Duration oldest{};    ///< Of a value as it was told.
};

class LinkStall : public LinkStallTest, public testing::WithParamInterface<std::chrono::milliseconds> {};

TEST_P(LinkStall, LosesNobodyAndKeepsReceiveTimesTrue) {
  start();
  Drives drives;
  run_for(1s);
  ASSERT_EQ(falsely_lost(), 0);
  drives.mute();
  stand_still(GetParam());
  run_for(2s);
  drives.stop();
  ASSERT_TRUE(run_until([&] { return received_frames == drives.sent(); }));
  EXPECT_EQ(lost, 0U);
  EXPECT_EQ(falsely_lost(), 0);
  EXPECT_TRUE(lost_at[kMute]);
  EXPECT_GE(oldest, GetParam() - 50ms) << "nothing waited";
  EXPECT_LT(latest, 50ms);
  EXPECT_GT(earliest, -1ms);
}

INSTANTIATE_TEST_SUITE_P(Of, LinkStall, testing::Values(1450ms, 5000ms),
                         [](const auto& parameter) { return std::to_string(parameter.param.count()) + "ms"; });

// The newest frames are dropped, and the kernel tells the number with the next frame, which does not come here.
TEST_F(LinkStallTest, WhereTheSocketRanOverSilenceCountsFromTheEndOfTheDrain) {
  {
    const WithoutNetAdmin unprivileged;
    start();
  }
  Drives drives;
  run_for(1s);
  stand_still(3s);
  drives.stop();
  stand_still(50ms);
  const TimePoint drained = Clock::now();
  run_for(1300ms);
  EXPECT_GT(lost, 0U);
  EXPECT_EQ(received_frames + lost, drives.sent());
  EXPECT_EQ(falsely_lost(), 0) << "their heartbeats were among the lost frames";
  ASSERT_TRUE(run_until([&] { return falsely_lost() == kDrives; }));
  EXPECT_GE(*lost_at[1], drained + 1500ms);
  EXPECT_LE(*lost_at[1], drained + 1700ms);
}

}  // namespace
}  // namespace canopen
