// A node of which nothing tells whether it is operational: it may be running, so nothing is written to it but what
// makes it tell, and that only where it does no harm.

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/canopen/node_life_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class UnknownStateTest : public NodeLifeBench {
 protected:
  /// Operational without heartbeat, TPDOs or guarding.
  void start_unknown(const NodeSettings& settings) {
    install(settings);
    slave_.set(kHeartbeatTime, DataType::u16, 0);
    slave_.set_state(5);
    start(settings);
  }
  /// Its life guarding would begin with the first request (CiA 301 7.2.8.2.2.1).
  void set_life_guarding() {
    slave_.set({0x100C, 0}, DataType::u16, 500);
    slave_.set({0x100D, 0}, DataType::u8, 3);
  }
  static NodeSettings without_heartbeat_settings() {
    NodeSettings settings = bench_settings();
    settings.error_control.heartbeat = Duration::zero();
    return settings;
  }
};

TEST_F(UnknownStateTest, ErrorControlIsSetFirstAndTheHeartbeatDecides) {
  start_unknown(bench_settings());
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  loop_.advance(6s, 5ms);
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kHeartbeatTime}) << "the one write before it was known";
  EXPECT_TRUE(nmt_heard().empty());
  expect_letter(BootResult::left_alone, "0x1A00:02");
}

TEST_F(UnknownStateTest, OfErrorControlOnlyTheHeartbeatOfTheDriveIsSetBeforeItsStateIsKnown) {
  NodeSettings settings = bench_settings();
  settings.error_control.supervise_gateway = 2s;
  slave_.set({0x1016, 1}, DataType::u32, 0);
  start_unknown(settings);
  loop_.advance(6s, 5ms);
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kHeartbeatTime});
  expect_letter(BootResult::left_alone, "0x1016:01");
}

TEST_F(UnknownStateTest, ARunningDriveAsWantedIsTakenOver) {
  start_unknown(bench_settings());
  ASSERT_TRUE(wait_online(4s)) << status().boot_text;
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kHeartbeatTime});
  EXPECT_EQ(events_.arrivals, std::vector<Arrival>{Arrival::taken_over});
}

TEST_F(UnknownStateTest, FoundRunningItIsHeldWhenItLeavesByItself) {
  start_unknown(bench_settings());
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  loop_.advance(6s, 5ms);
  ASSERT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
  leave_operational();
  loop_.advance(20s, 10ms);
  expect_let_be();
}

TEST_F(UnknownStateTest, AnotherDeviceIsNotWrittenTo) {
  NodeSettings settings = bench_settings();
  settings.identity.vendor = 0x91;
  start_unknown(settings);
  loop_.advance(10s, 5ms);
  EXPECT_TRUE(slave_.writes().empty());
  expect_letter(BootResult::other_vendor, "0x1018:01");
}

TEST_F(UnknownStateTest, WhereLifeGuardingIsSetNoHeartbeatIsSwitchedOnAndNoRequestStartsIt) {
  NodeSettings settings = with_motor();
  settings.error_control.has_guarding = true;
  start_unknown(settings);
  slave_.answer_guarding(true);
  set_life_guarding();
  slave_.set(kStatusWord, DataType::u16, 0x0627);
  loop_.advance(70s, 10ms);
  EXPECT_TRUE(slave_.heard_on(0x705).empty());
  EXPECT_TRUE(slave_.writes().empty());
  expect_letter(BootResult::left_alone, "its motor runs");
}

TEST_F(UnknownStateTest, WhereLifeGuardingIsSetAndItsMotorStandsTheFirstHeartbeatEndsTheWrites) {
  NodeSettings settings = with_motor();
  set_life_guarding();
  slave_.set(kStatusWord, DataType::u16, 0);
  slave_.delay_answers(5ms);
  start_unknown(settings);
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  loop_.advance(10s, 5ms);
  EXPECT_EQ(slave_.writes(), std::vector<ObjectAddress>{kHeartbeatTime});
  expect_letter(BootResult::left_alone, "our configuration of it was interrupted: 1 objects were written");
}

TEST_F(UnknownStateTest, LeftAloneItAnswersAndIsNotLost) {
  NodeSettings settings = with_motor();
  start_unknown(settings);
  set_life_guarding();
  slave_.set(kStatusWord, DataType::u16, 0x0627);
  loop_.advance(4s, 10ms);
  expect_letter(BootResult::left_alone, "its motor runs");
  slave_.forget_heard();
  loop_.advance(60s, 10ms);
  EXPECT_LE(slave_.reads().size(), 12U) << "one look a minute";
  EXPECT_FALSE(status().lost);
  const auto started = command(NmtCommand::start, 5s);
  loop_.advance(5s, 10ms);
  ASSERT_TRUE(started.done());
  ASSERT_TRUE(started.get().has_error());
  EXPECT_EQ(started.get().error().kind, ErrorKind::refused) << to_string(started.get().error());
}

TEST_F(UnknownStateTest, WhereNothingWillEverTellTheMotorIsReadBeforeTheFirstWrite) {
  NodeSettings settings = with_motor();
  settings.error_control.heartbeat = Duration::zero();
  start_unknown(settings);
  slave_.set(kMapping, DataType::u32, kOtherMapping);
  loop_.advance(5s, 5ms);
  EXPECT_TRUE(slave_.writes().empty());
  expect_letter(BootResult::left_alone, "cannot be read");
  slave_.set(kStatusWord, DataType::u16, 0x0627);
  loop_.advance(61s, 10ms);
  EXPECT_TRUE(slave_.writes().empty());
  expect_letter(BootResult::left_alone, "its motor runs");
  slave_.set(kStatusWord, DataType::u16, 0x0650);
  EXPECT_TRUE(wait_online(70s)) << "it is looked at again each minute";
  EXPECT_EQ(slave_.value(kMapping), kWantedMapping);
}

// A TPDO that came before pre-operational by command says nothing of the time after it.
TEST_F(UnknownStateTest, MadePreOperationalItIsNotTakenForOperationalByAnOlderTpdo) {
  running(without_heartbeat_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 0);
  slave_.set(kTpdoEventTimer, DataType::u16, 0);
  start(without_heartbeat_settings());
  send_tpdo(0x27, 1);
  loop_.advance(1s);
  ASSERT_EQ(status().boot_result, BootResult::left_alone) << status().boot_text;
  send_tpdo(0x27, 1);
  ASSERT_TRUE(command_now(NmtCommand::pre_operational).has_value());
  loop_.advance(100ms);
  slave_.set(kTpdoEventTimer, DataType::u16, 100);
  const auto started = command(NmtCommand::start, 5s);
  loop_.advance(5s, 10ms);
  ASSERT_TRUE(started.done());
  EXPECT_EQ(started.get().has_value(), slave_.state() == 5) << "success means that it was started";
}

TEST_F(UnknownStateTest, ASlowHeartbeatIsToldWhileItIsWaitedFor) {
  running(bench_settings());
  slave_.set(kHeartbeatTime, DataType::u16, 65'535);
  loop_.advance(10ms);
  start(bench_settings());
  loop_.advance(3s, 5ms);
  EXPECT_NE(status().boot_text.find("every 65535 ms"), std::string::npos) << status().boot_text;
  expect_untouched();
}

}  // namespace
}  // namespace canopen
