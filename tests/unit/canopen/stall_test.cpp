// The gateway was not scheduled for a while: what its drives sent meanwhile waits with the receive times that are true.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "canopen/bus/bus.h"
#include "canopen/node/remote_node.h"
#include "tests/support/lagging_link.h"
#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

constexpr std::uint8_t kDrives = 20;
constexpr Duration kTpdoPeriod = 40ms;  ///< 500 TPDOs a second of all drives.

/// The milliseconds of a moment that a TPDO of four bytes carries.
std::uint32_t milliseconds(TimePoint at) {
  return static_cast<std::uint32_t>(at.time_since_epoch() / 1ms);
}

/// One drive of many that run, and how far its values' receive times were from the truth at worst.
class Drive final : public NodeEvents {
 public:
  Drive(const boost::asio::any_io_executor& executor, VirtualBus& wire, Bus& bus, std::uint8_t number)
      : number_(number), slave_(executor, wire, number), node_(executor, bus, settings(number), *this) {
    slave_.set({0x1017, 0}, DataType::u16, 500);
    slave_.set_state(5);
    node_.start();
  }

  void on_status(const NodeStatus& status) override {
    if (status.lost && !lost_at) {
      lost_at = Clock::now();
    }
  }
  void on_boot_up() override {}
  void on_arrival(Arrival) override {}
  void on_tpdo(std::uint16_t, std::span<const Raw> values, TimePoint at, WallTime) override {
    const auto sent = static_cast<std::uint32_t>(values[0] | (values[1] << 16U));
    worst_error = std::max(worst_error, std::max(milliseconds(at), sent) - std::min(milliseconds(at), sent));
    last_at = at;
    ++tpdos;
  }
  void on_tpdo_length(std::uint16_t, std::size_t, std::size_t) override {}
  void on_emcy(const Emcy&, TimePoint, WallTime) override {}
  void on_frames_lost() override { ++losses; }
  void on_remark(const std::string&) override {}

  void send_tpdo() {
    const std::uint32_t now = milliseconds(Clock::now());
    const auto byte = [now](unsigned shift) { return static_cast<std::uint8_t>((now >> shift) & 0xFFU); };
    slave_.send(0x180U + number_, {byte(0), byte(8), byte(16), byte(24)});
  }
  void unplug() { slave_.unplug(true); }
  [[nodiscard]] RemoteNode& node() { return node_; }

  std::optional<TimePoint> lost_at;
  std::uint32_t worst_error = 0;  ///< ms
  TimePoint last_at;
  std::size_t tpdos = 0;
  int losses = 0;

 private:
  static NodeSettings settings(std::uint8_t number) {
    NodeSettings settings;
    settings.node = number;
    PdoSettings tpdo;
    tpdo.communication = SetupPolicy::assume;
    tpdo.mapping_policy = SetupPolicy::assume;
    tpdo.cob_id = 0x180U + number;
    tpdo.mapping = {{{0x6041, 0}, DataType::u16, 16, FieldUse::commanded},
                    {{0x6044, 0}, DataType::u16, 16, FieldUse::commanded}};
    settings.tpdos = {tpdo};
    return settings;
  }

  std::uint8_t number_;
  support::ScriptedSlave slave_;
  RemoteNode node_;
};

class StallTest : public testing::Test {
 protected:
  StallTest() {
    bus_.start();
    for (std::uint8_t number = 1; number <= kDrives; ++number) {
      drives_.push_back(std::make_unique<Drive>(loop_.executor(), wire_, bus_, number));
    }
    run(5s);
  }
  ~StallTest() override {
    for (const auto& drive : drives_) {
      const auto stopped = support::spawn(loop_.executor(), drive->node().stop());
      loop_.settle();
      EXPECT_TRUE(*stopped);
    }
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }

  static BusSettings quiet_bus() {
    BusSettings settings;
    settings.heartbeat = Duration::zero();
    return settings;
  }
  void run(Duration time) {
    for (Duration passed{}; passed < time; passed += kTpdoPeriod) {
      for (const auto& drive : drives_) {
        drive->send_tpdo();
      }
      loop_.advance(kTpdoPeriod, 5ms);
    }
  }
  void expect_all_online() {
    for (const auto& drive : drives_) {
      ASSERT_TRUE(drive->node().status().online) << drive->node().status().boot_text;
      drive->lost_at.reset();
      drive->tpdos = 0;
      drive->worst_error = 0;
    }
  }

  support::HandDrivenLoop loop_;
  VirtualBus wire_{loop_.executor()};
  std::unique_ptr<support::LaggingLink> made_ =
      std::make_unique<support::LaggingLink>(loop_.executor(), wire_.connect());
  support::LaggingLink& link_ = *made_;
  Bus bus_{loop_.executor(), std::move(made_), quiet_bus()};
  std::vector<std::unique_ptr<Drive>> drives_;
};

class Stall : public StallTest, public testing::WithParamInterface<std::chrono::milliseconds> {};

TEST_P(Stall, LosesNobodyWhoseHeartbeatWaitsAndKeepsReceiveTimesTrue) {
  expect_all_online();
  link_.stall();
  run(GetParam());
  ASSERT_GT(link_.waiting(), 5 * support::LaggingLink::kBatch) << "more than one batch waits";
  link_.resume();
  loop_.settle();
  run(3s);
  for (const auto& drive : drives_) {
    EXPECT_FALSE(drive->lost_at);
    EXPECT_TRUE(drive->node().status().online);
    EXPECT_EQ(drive->node().status().heartbeat_losses, 0U);
    EXPECT_GE(drive->tpdos, static_cast<std::size_t>((GetParam() + 3s) / kTpdoPeriod));
    EXPECT_LE(drive->worst_error, 5U);
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Stall, testing::Values(1450ms, 5000ms),
                         [](const auto& parameter) { return std::to_string(parameter.param.count()) + "ms"; });

TEST_F(StallTest, ADriveThatFellSilentMeanwhileIsLostOnceThatIsRead) {
  expect_all_online();
  link_.stall();
  drives_[6]->unplug();
  run(5s);
  EXPECT_FALSE(drives_[6]->lost_at) << "its heartbeats might wait";
  const TimePoint read = Clock::now();
  link_.resume();
  loop_.settle();
  run(kTpdoPeriod);
  EXPECT_TRUE(drives_[6]->lost_at && *drives_[6]->lost_at <= read + 5ms);
  for (std::size_t i = 0; i < kDrives; ++i) {
    EXPECT_TRUE(i == 6 || !drives_[i]->lost_at);
  }
}

TEST_F(StallTest, WhereTheSocketRanOverSilenceCountsFromTheEndOfTheDrain) {
  expect_all_online();
  link_.stall(1000);  // About two seconds of frames: the last three are lost.
  drives_[6]->unplug();
  run(5s);
  const TimePoint drained = Clock::now();
  link_.resume();
  loop_.settle();
  run(3s);
  for (std::size_t i = 0; i < kDrives; ++i) {
    EXPECT_GT(drives_[i]->losses, 0);
    EXPECT_TRUE(i == 6 || !drives_[i]->lost_at) << "its heartbeats were among the lost frames";
  }
  ASSERT_TRUE(drives_[6]->lost_at);
  EXPECT_GE(*drives_[6]->lost_at, drained + 1495ms);
  EXPECT_LE(*drives_[6]->lost_at, drained + 1510ms);
}

}  // namespace
}  // namespace canopen
