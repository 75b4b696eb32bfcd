#include "canopen/bus/bus_watch.h"

#include <gtest/gtest.h>

#include <vector>

#include "canopen/nmt_frame.h"
#include "canopen/node/node_settings.h"
#include "tests/support/bus_fixture.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;

constexpr BusSettings kOurs{.bitrate = 125000, .node_id = 127, .heartbeat = 500ms, .sync = 100ms};

class BusWatchTest : public support::BusFixture {
 protected:
  void watch(const BusSettings& settings, bool other_master = false) {
    bus_ = start(settings);
    watch_ = std::make_unique<BusWatch>(
        loop.executor(), *bus_, other_master,
        BusWatch::Handlers{.changed = [this](const BusTroubles& troubles) { told_.push_back(troubles); },
                           .remark = [this](const std::string& text) { remarks_.push_back(text); }});
    watch_->start();
  }
  void hear(const Frame& heard) {
    EXPECT_EQ(other.link->send(heard), SendResult::handed_over);
    loop.settle();
  }
  [[nodiscard]] BusTroubles now() const { return told_.empty() ? BusTroubles{} : told_.back(); }

  std::unique_ptr<Bus> bus_;
  std::vector<BusTroubles> told_;
  std::vector<std::string> remarks_;
  std::unique_ptr<BusWatch> watch_;
};

TEST_F(BusWatchTest, OurOwnTrafficIsNoSign) {
  watch(kOurs);
  const Ticket nmt = bus_->send(TransmitClass::command, nmt_frame(NmtCommand::start, 5), Clock::now() + 1s);
  const Ticket sdo = bus_->send(TransmitClass::sdo, frame(0x605, 0x40), Clock::now() + 1s);
  loop.advance(2s);
  EXPECT_GE(other.count(0x080), 10U);
  EXPECT_EQ(other.count(0x000), 1U);
  EXPECT_EQ(other.count(0x605), 1U);
  EXPECT_TRUE(told_.empty());
}

TEST_F(BusWatchTest, EachKindOfAForeignMasterIsNamedOnce) {
  watch(kOurs);
  hear(nmt_frame(NmtCommand::stop, 5));
  EXPECT_EQ(now().second_master, "another master or a tool is on the bus: it sends NMT commands (stop to node 5)");
  for (int i = 0; i < 50; ++i) {
    hear(nmt_frame(NmtCommand::start, 6));
    hear(frame(0x607, 0x40));
    hear(frame(0x080));
  }
  EXPECT_EQ(now().second_master,
            "another master or a tool is on the bus: it sends NMT commands (stop to node 5), SDO requests (to node 7), "
            "SYNC beside ours");
  EXPECT_EQ(told_.size(), 3U) << "one for each kind, not for each frame";
  EXPECT_TRUE(remarks_.empty());
}

TEST_F(BusWatchTest, AForeignMasterIsForgottenAMinuteAfterItsLastSign) {
  watch(kOurs);
  hear(nmt_frame(NmtCommand::start, 0));
  loop.advance(59s, 100ms);
  EXPECT_EQ(now().second_master, "another master or a tool is on the bus: it sends NMT commands (start to all nodes)");
  hear(nmt_frame(NmtCommand::start, 0));
  loop.advance(59s, 100ms);
  EXPECT_FALSE(now().second_master.empty());
  loop.advance(1500ms, 100ms);
  EXPECT_TRUE(now().second_master.empty());
}

TEST_F(BusWatchTest, AWantedMasterIsARemarkOnly) {
  watch(kOurs, true);
  hear(nmt_frame(NmtCommand::stop, 5));
  hear(nmt_frame(NmtCommand::stop, 5));
  hear(frame(0x605, 0x40));
  loop.advance(1s);
  EXPECT_TRUE(told_.empty());
  ASSERT_EQ(remarks_.size(), 2U);
  EXPECT_EQ(remarks_[1],
            "another master or a tool is on the bus: it sends NMT commands (stop to node 5), SDO requests (to node 5)");
}

TEST_F(BusWatchTest, WhatCommandsANodeIsOursAloneToSend) {
  NodeSettings node;
  node.node = 5;
  PdoSettings commands;
  commands.cob_id = 0x205;
  commands.mapping = {{{0x6040, 0}, DataType::u16, 16, FieldUse::commanded}};
  PdoSettings others;  // Nothing of it is commanded by us.
  others.cob_id = 0x305;
  others.mapping = {{{0x6071, 0}, DataType::i16, 16, FieldUse::unnamed}};
  node.rpdos = {commands, others};
  watch(kOurs);
  watch_->watch_commands_to(node);
  const Ticket own = bus_->send(TransmitClass::command, frame(0x205, 6), Clock::now() + 1s);
  hear(frame(0x305, 6));
  hear(frame(0x206, 6));
  EXPECT_TRUE(told_.empty());
  hear(frame(0x205, 15));
  hear(frame(0x205, 15));
  EXPECT_EQ(now().second_master,
            "another master or a tool is on the bus: it sends RPDOs (to node 5), unless a TPDO of another drive has "
            "that identifier");
  EXPECT_EQ(told_.size(), 1U);
}

TEST_F(BusWatchTest, SyncOfOthersIsUsualWhereWeSendNone) {
  watch({.bitrate = 125000, .node_id = 127, .heartbeat = 500ms});
  hear(frame(0x080));
  loop.advance(1s);
  EXPECT_TRUE(told_.empty());
}

TEST_F(BusWatchTest, AHeartbeatWithOurNodeIdIsTold) {
  watch(kOurs, true);
  hear(frame(0x77F, 5));
  EXPECT_TRUE(now().own_node_id) << "also where another master is wanted";
  loop.advance(61s, 100ms);
  EXPECT_FALSE(now().own_node_id);
}

TEST_F(BusWatchTest, AMasterWithoutNodeIdOwnsNone) {
  watch({.bitrate = 125000, .node_id = 0, .heartbeat = {}});
  hear(frame(0x700, 5));
  hear(frame(0x77F, 5));
  loop.advance(1s);
  EXPECT_TRUE(told_.empty());
}

TEST_F(BusWatchTest, OverloadBeginsAbove90PercentOfASecondAndEndsBelow80) {
  watch({.bitrate = 125000, .node_id = 0, .heartbeat = {}});
  const Frame full{.id = 0x185, .size = 8};
  // At 120 bits a frame.
  const auto load = [&](double share, Duration duration) {
    const auto frames = static_cast<int>(share * 125000.0 / 120.0 / 10.0);
    for (Duration passed{}; passed < duration; passed += 100ms) {
      for (int i = 0; i < frames; ++i) {
        EXPECT_EQ(other.link->send(full), SendResult::handed_over);
      }
      loop.advance(100ms, 10ms);
    }
  };
  load(0.88, 3s);
  EXPECT_FALSE(now().overload);
  load(0.5, 1s);
  load(0.96, 600ms);
  EXPECT_FALSE(now().overload) << "not yet for a second";
  load(0.96, 1s);
  EXPECT_TRUE(now().overload);
  load(0.85, 3s);
  EXPECT_TRUE(now().overload);
  load(0.75, 1500ms);
  EXPECT_FALSE(now().overload);
  EXPECT_EQ(told_.size(), 2U);
}

}  // namespace
}  // namespace canopen
