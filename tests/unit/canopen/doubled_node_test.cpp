// Two drives on one node id: what the gateway makes of it.

#include <gtest/gtest.h>

#include "tests/unit/canopen/node_bench.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;

class DoubledNodeTest : public NodeCommandBench {
 protected:
  DoubledNodeTest() {
    install(bench_settings());
    slave_.set({0x1018, 4}, DataType::u32, 1001);
    for (const ObjectAddress object : {ObjectAddress{0x1000, 0}, ObjectAddress{0x1018, 1}, kHeartbeatTime}) {
      spare_.set(object, DataType::u32, slave_.value(object));
    }
    spare_.set({0x1018, 4}, DataType::u32, 1002);
    spare_.unplug(true);
  }
  void plug_in_spare() {
    spare_.unplug(false);
    spare_.boot_up();
  }
  [[nodiscard]] bool wait_for(Doubled verdict, Duration limit) {
    return loop_.advance_until([&] { return status().doubled == verdict; }, limit);
  }

  support::ScriptedSlave spare_{loop_.executor(), wire_, kTestNode};
};

TEST_F(DoubledNodeTest, OneDriveRaisesNothing) {
  bring_online(bench_settings());
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(command_now(NmtCommand::stop).has_value());
    loop_.advance(3s);
    ASSERT_TRUE(command_now(NmtCommand::start).has_value());
    loop_.advance(3s);
    ASSERT_TRUE(command_now(NmtCommand::reset_node).has_value());
    slave_.boot_up();
    ASSERT_TRUE(wait_online(5s));
    loop_.advance(3s);
  }
  for (const NodeStatus& told : events_.statuses) {
    EXPECT_EQ(told.doubled, Doubled::no) << told.doubled_text;
  }
}

TEST_F(DoubledNodeTest, ARampingTpdoOnChangeIsNoSign) {
  bring_online(bench_settings());
  for (int i = 0; i < 2000; ++i) {
    send_tpdo(0x27, static_cast<std::uint16_t>(i));
    loop_.advance(1ms);
  }
  EXPECT_EQ(status().doubled, Doubled::no) << status().doubled_text;
}

TEST_F(DoubledNodeTest, TwoFromTheStartAreKnownByTheirBootUps) {
  start(bench_settings());
  slave_.boot_up();
  loop_.advance(100ms);
  plug_in_spare();
  ASSERT_TRUE(wait_for(Doubled::proof, 1s));
  EXPECT_EQ(status().doubled_text, "two boot-ups within one heartbeat period, and nobody reset it");
  loop_.advance(3s);
  const Sent sent = write(7);
  loop_.settle();
  ASSERT_TRUE(sent.done());
  const Result<void> refused = sent.get();
  ASSERT_TRUE(refused.has_error());
  EXPECT_EQ(refused.error().kind, ErrorKind::offline);
  EXPECT_TRUE(slave_.writes().empty() || slave_.writes().back() != kControlWord);
}

TEST_F(DoubledNodeTest, OneThatComesLaterIsFound) {
  bring_online(bench_settings());
  ASSERT_TRUE(rpdo_now({control(7), target(100)}).has_value());
  plug_in_spare();
  ASSERT_TRUE(wait_for(Doubled::proof, 15s)) << status().doubled_text;
  loop_.advance(1s);
  const Result<void> refused = rpdo_now({control(7), target(100)});
  ASSERT_TRUE(refused.has_error());
  EXPECT_EQ(refused.error().kind, ErrorKind::offline);
}

TEST_F(DoubledNodeTest, ASilentSpareIsFoundByItsSerialNumber) {
  bring_online(bench_settings());
  // It woke up unheard, and speaks with the first one's heartbeat.
  spare_.unplug(false);
  spare_.set_state(5);
  ASSERT_TRUE(wait_for(Doubled::hint, 10s) || status().doubled == Doubled::proof);
  ASSERT_TRUE(wait_for(Doubled::proof, 15s)) << status().doubled_text;
  EXPECT_EQ(status().doubled_text, "two different SDO answers came to one request");
}

TEST_F(DoubledNodeTest, AStopIsSentOnceBySdo) {
  bring_online(bench_settings());
  spare_.unplug(false);
  spare_.set_state(5);
  ASSERT_TRUE(wait_for(Doubled::proof, 30s));
  slave_.forget_heard();
  const auto stopped =
      support::spawn(loop_.executor(), node_->write_stop(kControlWord, DataType::u16, 0, Clock::now() + kDeadline));
  loop_.advance(1s);
  ASSERT_TRUE(stopped.done());
  EXPECT_EQ(slave_.writes(), (std::vector<ObjectAddress>{kControlWord}));
}

TEST_F(DoubledNodeTest, IsOverAMinuteAfterTheSpareWasTakenAway) {
  bring_online(bench_settings());
  spare_.unplug(false);
  spare_.set_state(5);
  ASSERT_TRUE(wait_for(Doubled::proof, 30s));
  spare_.unplug(true);
  loop_.advance(65s, 5ms);
  EXPECT_EQ(status().doubled, Doubled::no) << status().doubled_text;
  EXPECT_TRUE(rpdo_now({control(7), target(100)}).has_value());
}

TEST_F(DoubledNodeTest, AnNmtStartEndsItAtOnce) {
  bring_online(bench_settings());
  spare_.unplug(false);
  spare_.set_state(5);
  ASSERT_TRUE(wait_for(Doubled::proof, 30s));
  spare_.unplug(true);
  loop_.advance(2s);
  ASSERT_TRUE(command_now(NmtCommand::start).has_value());
  EXPECT_EQ(status().doubled, Doubled::no);
  loop_.advance(1s);
  EXPECT_TRUE(rpdo_now({control(7), target(100)}).has_value());
}

TEST_F(DoubledNodeTest, LastsForAsLongAsBothAreThere) {
  bring_online(bench_settings());
  spare_.unplug(false);
  spare_.set_state(5);
  ASSERT_TRUE(wait_for(Doubled::proof, 30s));
  events_.statuses.clear();
  loop_.advance(180s, 2ms);
  for (const NodeStatus& told : events_.statuses) {
    EXPECT_EQ(told.doubled, Doubled::proof);
  }
  EXPECT_EQ(status().doubled, Doubled::proof);
}

TEST_F(DoubledNodeTest, OneThatIsNotServedIsLookedAtToo) {
  slave_.set({0x1018, 1}, DataType::u32, 0x91);
  NodeSettings settings = bench_settings();
  settings.identity.vendor = 0x90;
  slave_.set_state(5);
  start(settings);
  loop_.advance(5s);
  ASSERT_EQ(status().boot_result, BootResult::other_vendor);
  spare_.unplug(false);
  spare_.set_state(127);
  EXPECT_TRUE(wait_for(Doubled::proof, 30s)) << status().doubled_text;
}

// A healthy drive beside a PLC that reads what we read, and whose answers are slow.
TEST_F(DoubledNodeTest, APlcThatReadsTheSameIsNoSign) {
  bring_online(bench_settings());
  slave_.set({0x6044, 0}, DataType::i16, 0);
  for (int i = 0; i < 50; ++i) {
    slave_.set({0x6044, 0}, DataType::i16, static_cast<Raw>(i));
    slave_.send(0x605, {0x40, 0x18, 0x10, 4, 0, 0, 0, 0});
    const auto read = support::spawn(loop_.executor(), node_->read({0x1018, 4}, DataType::u32));
    loop_.advance(2ms);
    slave_.send(0x585, {0x43, 0x18, 0x10, 4, static_cast<std::uint8_t>(i), 0, 0, 0});
    loop_.advance(250ms);
  }
  EXPECT_EQ(status().doubled, Doubled::no) << status().doubled_text;
}

// Field case: a commissioning tool reads beside us; its answers are for nobody of ours.
TEST_F(DoubledNodeTest, AnswersToAnotherMastersRequestsAreNoSign) {
  bring_online(bench_settings());
  for (int i = 0; i < 20; ++i) {
    const auto read = support::spawn(loop_.executor(), node_->read({0x1018, 4}, DataType::u32));
    loop_.advance(20ms);
    slave_.send(0x605, {0x40, 0x18, 0x10, 4, 0, 0, 0, 0});
    slave_.send(0x585, {0x43, 0x18, 0x10, 4, static_cast<std::uint8_t>(i), 0, 0, 0});
    loop_.advance(20ms);
  }
  EXPECT_EQ(status().doubled, Doubled::no) << status().doubled_text;
}

}  // namespace
}  // namespace canopen
