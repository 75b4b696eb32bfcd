// As root: tests/vcan/run BUILD/tests/vcan/slcan_link_test
#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "tests/vcan/link_fixture.h"
#include "tests/vcan/slcan_adapter.h"

namespace canopen {
namespace {

using namespace std::chrono_literals;
using support::frame;
using support::shell;

/// A controller with states: slcan on a pseudo terminal, the test plays the adapter.
class SlcanLinkTest : public support::LinkFixture {
 protected:
  void SetUp() override {
    shell("modprobe slcan");
    adapter.emplace();
    shell("ip link set " + adapter->interface() + " type can bitrate 125000");
    shell("ip link set " + adapter->interface() + " txqueuelen 10 up");
  }
  void expect(BusCondition condition) {
    ASSERT_TRUE(run_until([&] { return events.is(condition); }))
        << "in condition " << static_cast<int>(events.states.back().condition);
  }
  /// Two looks at the controller: what an error frame told must agree with it.
  void expect_lasting(BusCondition condition) {
    expect(condition);
    run_for(2100ms);
    EXPECT_TRUE(events.is(condition)) << "in condition " << static_cast<int>(events.states.back().condition);
  }

  std::optional<support::SlcanAdapter> adapter;
};

TEST_F(SlcanLinkTest, StatesComeFromTheController) {
  open(adapter->interface());
  expect(BusCondition::error_active);
  adapter->say("sw100003");
  expect(BusCondition::warning);
  adapter->say("sp003128");  // Receive errors, then transmit errors.
  expect(BusCondition::passive);
  EXPECT_EQ(events.states.back(), (BusState{BusCondition::passive, 128, 3}));
  adapter->say("sa000000");
  expect(BusCondition::error_active);
  adapter->say("sb255255");
  expect_lasting(BusCondition::bus_off);
}

TEST_F(SlcanLinkTest, AMissingAcknowledgementIsToldApart) {
  open(adapter->interface());
  expect(BusCondition::error_active);
  adapter->say("e2bo");  // A bit error and an overrun, in one frame.
  ASSERT_TRUE(run_until([&] { return events.lost == 1; }));
  EXPECT_EQ(events.error_signs, std::vector<ErrorSign>{ErrorSign::other});
  adapter->say("e1a");
  ASSERT_TRUE(run_until([&] { return events.error_signs.size() == 2; }));
  EXPECT_EQ(events.error_signs.back(), ErrorSign::not_acknowledged);
  adapter->say("e1s");
  ASSERT_TRUE(run_until([&] { return events.error_signs.size() == 3; }));
  EXPECT_EQ(events.error_signs.back(), ErrorSign::other);
  EXPECT_TRUE(events.is(BusCondition::error_active));
}

TEST_F(SlcanLinkTest, AFrameThatIsReceivedInBusOffTellsThatItIsOver) {
  open(adapter->interface());
  expect(BusCondition::error_active);
  run_for(1500ms);
  // As if the error frame of the recovery were lost: the controller is error-active all the while.
  support::OtherSocket(adapter->interface()).send_error(CAN_ERR_BUSOFF, 0, 0, 0);
  expect(BusCondition::bus_off);
  const auto begun = std::chrono::steady_clock::now();
  adapter->say("t185281AA");
  expect(BusCondition::error_active);
  EXPECT_LT(std::chrono::steady_clock::now() - begun, 500ms) << "only at the next look";
}

TEST_F(SlcanLinkTest, AStateFromBeforeTheStartIsLearnt) {
  adapter->say("sp128000");
  shell("sleep 0.2");
  open(adapter->interface());
  expect(BusCondition::passive);
  link->close();
  adapter->say("sb255255");
  shell("sleep 0.2");
  events.states.clear();
  link->open(events);
  ASSERT_TRUE(run_until([&] { return !events.states.empty(); }));
  EXPECT_TRUE(events.is(BusCondition::bus_off));
}

TEST_F(SlcanLinkTest, APulledAdapterIsDown) {
  open(adapter->interface());
  expect(BusCondition::error_active);
  EXPECT_EQ(link->send(frame(0x605, 0x40)), SendResult::handed_over);
  ASSERT_TRUE(run_until([&] { return !events.echoes.empty(); }));
  ASSERT_TRUE(run_until([&] { return adapter->heard().ends_with("t605140\r"); })) << adapter->heard();
  adapter->say("t185281AA");
  ASSERT_TRUE(run_until([&] { return !events.received.empty(); }));
  EXPECT_EQ(events.received.front().frame, make_frame(0x185, std::array<std::uint8_t, 2>{0x81, 0xAA}));
  adapter.reset();
  expect(BusCondition::down);
  EXPECT_EQ(link->send(frame(0x605)), SendResult::down);
}

}  // namespace
}  // namespace canopen
