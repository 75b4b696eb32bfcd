// Life guarding that another master has set in a drive to which our guarding requests go already, or are about to.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "canopen/communication_objects.h"
#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class ForeignLifeGuardingTest : public NodeLifeBench {
 protected:
  void install_guarded(const NodeSettings& settings) {
    install(settings);
    slave_.set(kHeartbeatTime, DataType::u16, 0);
    set_life_guarding(0, 0);
    slave_.answer_guarding(true);
    slave_.set(kStatusWord, DataType::u16, 0x0627);  // Its motor runs.
  }
  void boot_guarded(const NodeSettings& settings) {
    install_guarded(settings);
    start(settings);
    slave_.boot_up();
    ASSERT_TRUE(wait_online()) << status().boot_text;
    loop_.advance(3s);
  }
  void set_life_guarding(Raw guard_time, Raw factor) {
    slave_.set(kGuardTime, DataType::u16, guard_time);
    slave_.set(kLifeTimeFactor, DataType::u8, factor);
  }
  [[nodiscard]] std::size_t requests() const {
    const std::vector<Frame> heard = slave_.heard_on(0x705);
    return static_cast<std::size_t>(
        std::count_if(heard.begin(), heard.end(), [](const Frame& frame) { return frame.remote; }));
  }
  /// A power dip: it is lost, its boot-up is not heard, and it has what another master once stored in it.
  void come_back_armed(std::uint8_t state) {
    slave_.answer_guarding(false);
    slave_.mute_sdo(true);
    slave_.set_state(state);
    set_life_guarding(100, 3);
    ASSERT_TRUE(loop_.advance_until([this] { return status().lost; }, 2s));
    slave_.answer_guarding(true);
    slave_.mute_sdo(false);
  }
  void expect_no_request_from_now_on() {
    slave_.forget_heard();
    loop_.advance(60s, 5ms);
    EXPECT_EQ(requests(), 0U);
    EXPECT_TRUE(slave_.writes().empty());
    EXPECT_TRUE(nmt_heard().empty());
  }
};

TEST_F(ForeignLifeGuardingTest, AfterALossTheRequestsEndWhereItIsFound) {
  boot_guarded(guarded_each(200ms));
  come_back_armed(127);
  ASSERT_TRUE(loop_.advance_until([this] { return told("another master has set life guarding"); }, 5s));
  EXPECT_EQ(status().boot_result, BootResult::not_configured);
  const unsigned losses = status().heartbeat_losses;
  expect_no_request_from_now_on();
  EXPECT_EQ(status().heartbeat_losses, losses) << "nothing is asked, so nothing is missing";
}

TEST_F(ForeignLifeGuardingTest, TheSameWhereItRuns) {
  boot_guarded(guarded_each(200ms));
  come_back_armed(5);
  ASSERT_TRUE(loop_.advance_until([this] { return told("another master has set life guarding"); }, 5s));
  EXPECT_EQ(status().boot_result, BootResult::left_alone);
  const unsigned losses = status().heartbeat_losses;
  expect_no_request_from_now_on();
  EXPECT_EQ(status().heartbeat_losses, losses);
}

TEST_F(ForeignLifeGuardingTest, TheSameWhereOurOwnWouldBeAnother) {
  NodeSettings settings = guarded_each(200ms);
  settings.error_control.supervise_gateway = 1s;
  boot_guarded(settings);
  come_back_armed(5);
  ASSERT_TRUE(loop_.advance_until([this] { return told("0x100C:00 guard time: expected 200, found 100"); }, 5s));
  EXPECT_EQ(status().boot_result, BootResult::left_alone);
  expect_no_request_from_now_on();
}

TEST_F(ForeignLifeGuardingTest, ReadAndRebootedAtOnceNoRequestLeavesBeforeItIsReadAnew) {
  install_guarded(guarded_each(200ms));
  const std::unique_ptr<Link> other = wire_.connect();
  bool rebooted = false;
  // The last answer of the check, and its boot-up with what another master stored, in one batch.
  slave_.script([&](const Bytes& request) -> Answers {
    if (!reads(request, kHeartbeatTime) || std::exchange(rebooted, true)) {
      return std::nullopt;
    }
    static_cast<void>(other->send(make_frame(0x585, Bytes{0x4B, 0x17, 0x10, 0, 0, 0, 0, 0})));
    static_cast<void>(other->send(make_frame(0x705, Bytes{0})));
    set_life_guarding(100, 3);
    return std::vector<Bytes>{};
  });
  start(guarded_each(200ms));
  slave_.boot_up();
  ASSERT_TRUE(loop_.advance_until([&] { return rebooted; }, 5s));
  loop_.advance(10s, 1ms);
  EXPECT_EQ(requests(), 0U);
  expect_letter(BootResult::not_configured, "another master has set life guarding");
}

}  // namespace
}  // namespace canopen
