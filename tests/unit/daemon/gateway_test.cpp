#include "daemon/gateway.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <string>

#include "canopen/bus/virtual_link.h"
#include "daemon/temporary_directory.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/daemon/demo_model.h"

namespace gateway {
namespace {

using namespace std::chrono_literals;

class GatewayTest : public testing::Test {
 protected:
  GatewayTest() {
    model_.modbus.reset();
    model_.mqtt.reset();
    model_.http.reset();
  }

  /// Whether there is an alarm of the bus soon after a start.
  bool alarm_after_start() {
    Gateway gateway(loop_.executor(), model_, [this](const config::Bus&) { return wire_.connect(); });
    gateway.start();
    loop_.advance(100ms);
    const bool active = gateway.plant().bus_alarm(0).active;
    const auto stopped = support::spawn(loop_.executor(), gateway.stop());
    EXPECT_TRUE(loop_.advance_until([&] { return *stopped; }, 5s));
    return active;
  }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  config::Model model_ = test::demo_model();
};

TEST_F(GatewayTest, TellsABusThatIsDownFromTheStart) {
  wire_.set_state({canopen::BusCondition::down, 0, 0});
  EXPECT_TRUE(alarm_after_start());
}

TEST_F(GatewayTest, TellsNothingOfABusThatWorks) {
  EXPECT_FALSE(alarm_after_start());
}

/// A gateway that is started again and again with one state directory, on a bus without drives.
class RestartedGatewayTest : public GatewayTest {
 protected:
  using Kind = alarms::AlarmKind;

  RestartedGatewayTest() {
    model_.gateway.control.clear();
    model_.gateway.state_dir = (directory_.path() / "state").string();
    start();
  }
  ~RestartedGatewayTest() override { stop(); }

  void start() {
    gateway_ =
        std::make_unique<Gateway>(loop_.executor(), model_, [this](const config::Bus&) { return wire_.connect(); });
    gateway_->start();
  }
  void stop() {
    if (gateway_) {
      const auto stopped = support::spawn(loop_.executor(), gateway_->stop());
      await([&] { return *stopped; });
      gateway_.reset();
    }
  }
  /// The disk's thread has its own time.
  template <class Predicate>
  void await(Predicate done) {
    for (int i = 0; i < 900 && !done(); ++i) {
      loop_.advance(1ms);
      loop_.context().run_one_for(10ms);
    }
    ASSERT_TRUE(done());
  }
  [[nodiscard]] const alarms::Alarm& alarm(Kind kind) { return gateway_->plant().drive(0).alarm(kind); }
  [[nodiscard]] const alarms::Alarm& bus_alarm() { return gateway_->plant().bus_alarm(0); }
  void await_kept(const std::string& id) {
    await([&] {
      std::ifstream file(directory_.path() / "state" / "alarms.json");
      return std::string(std::istreambuf_iterator<char>(file), {}).find(id) != std::string::npos;
    });
  }
  static void expect_same(const alarms::Alarm& now, const alarms::Alarm& before) {
    EXPECT_TRUE(now.active);
    EXPECT_EQ(now.id, before.id);
    EXPECT_EQ(now.since, before.since);
    EXPECT_EQ(now.count, before.count);
    EXPECT_EQ(now.text, before.text);
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Gateway> gateway_;
};

TEST_F(RestartedGatewayTest, AlarmsOfDrivesGoOn) {
  loop_.advance(10s);
  const alarms::Alarm before = alarm(Kind::heartbeat);
  ASSERT_TRUE(before.active);
  await_kept(before.id);
  stop();
  start();
  expect_same(alarm(Kind::heartbeat), before);
  EXPECT_FALSE(alarm(Kind::heartbeat).confirmed);
  EXPECT_TRUE(alarm(Kind::emcy).known);
  loop_.advance(10s);
  expect_same(alarm(Kind::heartbeat), before);
  EXPECT_TRUE(alarm(Kind::heartbeat).confirmed);
}

TEST_F(RestartedGatewayTest, AlarmsOfBusesGoOnUntilTheBusTells) {
  wire_.set_state({canopen::BusCondition::down, 0, 0});
  loop_.advance(100ms);
  const alarms::Alarm before = bus_alarm();
  ASSERT_TRUE(before.active);
  stop();
  start();
  expect_same(bus_alarm(), before);
  EXPECT_FALSE(bus_alarm().confirmed);
  loop_.advance(100ms);
  expect_same(bus_alarm(), before);
  EXPECT_TRUE(bus_alarm().confirmed);
  stop();
  wire_.set_state({canopen::BusCondition::error_active, 0, 0});
  start();
  loop_.advance(100ms);
  EXPECT_FALSE(bus_alarm().active);
  EXPECT_EQ(bus_alarm().id, before.id);
  EXPECT_NE(bus_alarm().cleared, canopen::WallTime{});
}

TEST_F(RestartedGatewayTest, ADriveThatIsNotConfiguredAnyMoreIsDropped) {
  loop_.advance(10s);
  const std::string gone = model_.drives[0].name;
  await_kept(alarm(Kind::heartbeat).id);
  stop();
  model_.drives[0].name = "another";
  start();
  EXPECT_FALSE(alarm(Kind::heartbeat).known);
  loop_.advance(10s);
  await_kept(alarm(Kind::heartbeat).id);
  std::ifstream file(directory_.path() / "state" / "alarms.json");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  EXPECT_EQ(text.find("\"" + gone + "\""), std::string::npos);
}

TEST_F(RestartedGatewayTest, ADriveOutOfServiceShowsNothingOfBefore) {
  loop_.advance(10s);
  await_kept(alarm(Kind::heartbeat).id);
  stop();
  model_.drives[0].enabled = false;
  start();
  EXPECT_FALSE(alarm(Kind::heartbeat).active);
}

TEST_F(RestartedGatewayTest, WithoutAStateDirectoryItWorksOn) {
  stop();
  model_.gateway.state_dir.clear();
  start();
  EXPECT_FALSE(alarm(Kind::heartbeat).known);
  loop_.advance(10s);
  EXPECT_TRUE(alarm(Kind::heartbeat).active);
}

}  // namespace
}  // namespace gateway
