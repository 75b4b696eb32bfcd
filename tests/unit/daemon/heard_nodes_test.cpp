#include "daemon/heard_nodes.h"

#include <gmock/gmock.h>

#include <map>
#include <string>
#include <vector>

#include "canopen/bus/virtual_link.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

canopen::Frame frame(std::uint32_t id, const std::vector<std::uint8_t>& bytes = {0x05}) {
  return canopen::make_frame(id, bytes);
}

std::string told_by(const canopen::Frame& frame) {
  const auto heard = sender_of(frame);
  return heard ? std::to_string(heard->node) + ": " + heard->by : "";
}

TEST(SenderOf, KnowsWhatANodeSends) {
  EXPECT_EQ(told_by(frame(0x705, {0})), "5: its boot-up (0x705)");
  EXPECT_EQ(told_by(frame(0x705)), "5: its heartbeat (0x705)");
  EXPECT_EQ(told_by(frame(0x705, {0x85})), "5: its heartbeat (0x705)");
  EXPECT_EQ(told_by(frame(0x085)), "5: an emergency (0x085)");
  EXPECT_EQ(told_by(frame(0x1FF)), "127: its TPDO1 (0x1FF)");
  EXPECT_EQ(told_by(frame(0x285)), "5: its TPDO2 (0x285)");
  EXPECT_EQ(told_by(frame(0x385)), "5: its TPDO3 (0x385)");
  EXPECT_EQ(told_by(frame(0x485)), "5: its TPDO4 (0x485)");
  EXPECT_EQ(told_by(frame(0x585)), "5: an SDO answer (0x585)");
}

// A gateway asks for its drives, and would send them what was commanded, before they are there.
TEST(SenderOf, WhatAMasterSendsTellsNothing) {
  for (const std::uint32_t id : {0x000U, 0x080U, 0x100U, 0x205U, 0x305U, 0x405U, 0x505U, 0x605U}) {
    EXPECT_EQ(told_by(frame(id)), "") << id;
  }
  canopen::Frame guarding = frame(0x705, {});
  guarding.remote = true;
  EXPECT_EQ(told_by(guarding), "");
  canopen::Frame extended = frame(0x705);
  extended.extended = true;
  EXPECT_EQ(told_by(extended), "");
  canopen::Frame error = frame(0x85);
  error.error = true;
  EXPECT_EQ(told_by(error), "");
}

class NodeWatchTest : public testing::Test {
 protected:
  struct Quiet final : canopen::LinkEvents {
    void on_frames(std::span<const canopen::Received> /*frames*/) override {}
    void on_echo(const canopen::Received& /*sent*/) override {}
    void on_bus_state(const canopen::BusState& /*state*/) override {}
    void on_frames_lost(std::uint32_t /*count*/) override {}
  };

  NodeWatchTest() {
    sender_->open(quiet_);
    watch_.add(*link_);
  }
  ~NodeWatchTest() override { sender_->close(); }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  Quiet quiet_;
  std::unique_ptr<canopen::Link> sender_ = wire_.connect();
  std::unique_ptr<canopen::Link> link_ = wire_.connect();
  canopen::VirtualBus other_wire_{loop_.executor()};
  std::unique_ptr<canopen::Link> other_ = other_wire_.connect();
  NodeWatch watch_{loop_.executor()};
};

TEST_F(NodeWatchTest, HearsEachNodeAndByWhatFirst) {
  const auto listening = support::spawn(loop_.executor(), watch_.listen(2s));
  loop_.advance(500ms);
  for (const std::uint32_t id : {0x185U, 0x705U, 0x605U, 0x709U}) {
    EXPECT_EQ(sender_->send(frame(id)), canopen::SendResult::handed_over);
  }
  loop_.advance(1400ms);
  EXPECT_FALSE(listening.done());
  loop_.advance(200ms);
  ASSERT_TRUE(listening.done());
  EXPECT_THAT(listening.get(),
              ElementsAre(ElementsAre(Pair(5, "its TPDO1 (0x185)"), Pair(9, "its heartbeat (0x709)"))));
}

TEST_F(NodeWatchTest, WaitsForABusThatIsDown) {
  wire_.set_state({canopen::BusCondition::down, 0, 0});
  const auto listening = support::spawn(loop_.executor(), watch_.listen(2s));
  loop_.advance(60s);
  EXPECT_FALSE(listening.done());
  wire_.set_state({canopen::BusCondition::error_active, 0, 0});
  loop_.advance(1900ms);
  EXPECT_FALSE(listening.done());
  loop_.advance(200ms);
  ASSERT_TRUE(listening.done());
  EXPECT_THAT(listening.get(), ElementsAre(IsEmpty()));
}

TEST_F(NodeWatchTest, BeginsAgainWhereTheBusWasDown) {
  const auto listening = support::spawn(loop_.executor(), watch_.listen(2s));
  loop_.advance(1900ms);
  wire_.set_state({canopen::BusCondition::down, 0, 0});
  loop_.advance(1s);
  wire_.set_state({canopen::BusCondition::error_active, 0, 0});
  loop_.advance(1900ms);
  EXPECT_FALSE(listening.done());
  loop_.advance(200ms);
  EXPECT_TRUE(listening.done());
}

TEST_F(NodeWatchTest, ForgetsWhoWasThereBeforeTheBusWasDown) {
  const auto listening = support::spawn(loop_.executor(), watch_.listen(2s));
  loop_.advance(100ms);
  EXPECT_EQ(sender_->send(frame(0x705)), canopen::SendResult::handed_over);
  loop_.advance(100ms);
  wire_.set_state({canopen::BusCondition::down, 0, 0});
  loop_.advance(1s);
  wire_.set_state({canopen::BusCondition::error_active, 0, 0});
  loop_.advance(2100ms);
  ASSERT_TRUE(listening.done());
  EXPECT_THAT(listening.get(), ElementsAre(IsEmpty()));
}

// A drive may be plugged in while another bus is waited for.
TEST_F(NodeWatchTest, HearsABusAsLongAsAnotherIsWaitedFor) {
  watch_.add(*other_);
  other_wire_.set_state({canopen::BusCondition::down, 0, 0});
  const auto listening = support::spawn(loop_.executor(), watch_.listen(2s));
  loop_.advance(60s, 5ms);
  EXPECT_FALSE(listening.done());
  EXPECT_EQ(sender_->send(frame(0x705)), canopen::SendResult::handed_over);
  loop_.advance(60s, 5ms);
  other_wire_.set_state({canopen::BusCondition::error_active, 0, 0});
  loop_.advance(1900ms);
  EXPECT_FALSE(listening.done());
  loop_.advance(200ms);
  ASSERT_TRUE(listening.done());
  EXPECT_THAT(listening.get(), ElementsAre(ElementsAre(Pair(5, "its heartbeat (0x705)")), IsEmpty()));
}

TEST_F(NodeWatchTest, BeginsAgainWhereAnyBusWasDown) {
  watch_.add(*other_);
  const auto listening = support::spawn(loop_.executor(), watch_.listen(2s));
  loop_.advance(1900ms);
  wire_.set_state({canopen::BusCondition::down, 0, 0});
  loop_.advance(1s);
  wire_.set_state({canopen::BusCondition::error_active, 0, 0});
  loop_.advance(1900ms);
  EXPECT_FALSE(listening.done());
  loop_.advance(200ms);
  EXPECT_TRUE(listening.done());
}

TEST_F(NodeWatchTest, EndsWhenItIsTold) {
  const auto listening = support::spawn(loop_.executor(), watch_.listen(2s));
  loop_.advance(100ms);
  watch_.stop();
  loop_.settle();
  EXPECT_TRUE(listening.done());
}

}  // namespace
}  // namespace gateway
