// The shipped profiles against simulated drives, which know nothing of them: the whole way from frame to alarm and
// back.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "bridges/process/drive.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "config/load.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"
#include "tests/unit/process/test_drive.h"

namespace process {
namespace {

using namespace std::chrono_literals;

struct Kind {
  std::string name;
  std::uint16_t fault;
  std::string text;  ///< How the alarm's text begins.
};

std::ostream& operator<<(std::ostream& out, const Kind& kind) {
  return out << kind.name;
}

std::string name_of_case(const testing::TestParamInfo<Kind>& parameter) {
  std::string name = parameter.param.name;
  std::ranges::replace(name, '-', '_');
  return name;
}

class ProfileTest : public testing::TestWithParam<Kind> {
 protected:
  ProfileTest() {
    const std::string site =
        "[[bus]]\nname = \"can0\"\ninterface = \"virtual\"\n"
        "[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"" +
        GetParam().name + "\"\n[drive.commands]\nwriters = [\"modbus\"]\n";
    const config::Loaded loaded =
        config::load_text(site, {"site.toml", {GATEWAY_SOURCE_DIR "/config/profiles"}, "host"});
    if (!loaded.model) {
      throw std::runtime_error("the profile does not load");
    }
    model_ = *loaded.model;
    bus_.start();
    network_.open();
    simulated_ = simulator::make_drive(GetParam().name, 5, network_);
  }
  ~ProfileTest() override {
    stop();
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }

  void start() {
    drive_ = std::make_unique<Drive>(loop_.executor(), model_.drives[0], 0, bus_, observers_);
    drive_->start();
  }
  void stop() {
    if (drive_) {
      const auto stopped = support::spawn(loop_.executor(), drive_->stop());
      loop_.settle();
      EXPECT_TRUE(*stopped);
      drive_.reset();
    }
  }
  void bring_online() {
    simulated_->power_on();
    start();
    ASSERT_TRUE(loop_.advance_until([&] { return drive_->status().online; }, 10s)) << drive_->status().boot_text;
    loop_.advance(3s);
  }
  [[nodiscard]] bool until(bool active) {
    return loop_.advance_until([&] { return emcy().active == active; }, 10s);
  }
  [[nodiscard]] const alarms::Alarm& emcy() const { return drive_->alarm(alarms::AlarmKind::emcy); }
  [[nodiscard]] bool all_tpdo_values_fresh() const {
    const auto sources = drive_->image().sources();
    return std::ranges::all_of(sources, [](const SourceState& source) {
      return source.source.kind != config::SourceKind::tpdo || source.fresh(canopen::Clock::now());
    });
  }

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  canopen::Bus bus_{loop_.executor(), wire_.connect(), {}};
  simulator::Network network_{loop_.executor(), wire_.connect()};
  std::unique_ptr<simulator::Drive> simulated_;
  config::Model model_;
  std::vector<Observer*> observers_;
  std::unique_ptr<Drive> drive_;
};

TEST_P(ProfileTest, ComesOnlineWithFreshValuesAndNoAlarm) {
  bring_online();
  EXPECT_TRUE(all_tpdo_values_fresh());
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    EXPECT_FALSE(drive_->alarm(kind).active) << name_of(kind) << ": " << drive_->alarm(kind).text;
  }
  EXPECT_TRUE(emcy().confirmed);
  EXPECT_EQ(simulated_->record().rpdo_total(), 0U);
  loop_.advance(30s);
  EXPECT_TRUE(all_tpdo_values_fresh());
  EXPECT_EQ(simulated_->record().rpdo_total(), 0U) << "RPDOs stay silent until somebody commands";
}

TEST_P(ProfileTest, FaultIsAnAlarmUntilItIsGone) {
  bring_online();
  simulated_->fault(GetParam().fault);
  ASSERT_TRUE(until(true));
  loop_.advance(2s);
  EXPECT_TRUE(emcy().active);
  EXPECT_EQ(emcy().count, 1U);
  EXPECT_EQ(emcy().severity, config::Severity::fault);
  EXPECT_EQ(emcy().text.substr(0, GetParam().text.size()), GetParam().text) << emcy().text;
  EXPECT_EQ(emcy().errors.size(), 1U);
  simulated_->clear_faults();
  ASSERT_TRUE(until(false));
  loop_.advance(5s);
  EXPECT_FALSE(emcy().active);
  EXPECT_EQ(emcy().count, 1U);
}

TEST_P(ProfileTest, FaultOfBeforeTheGatewaysStartIsFound) {
  bring_online();
  simulated_->fault(GetParam().fault);
  loop_.advance(1s);
  stop();
  start();
  ASSERT_TRUE(loop_.advance_until([&] { return drive_->status().online; }, 10s)) << drive_->status().boot_text;
  EXPECT_TRUE(until(true));
  loop_.advance(2s);
  EXPECT_TRUE(emcy().active);
  EXPECT_TRUE(emcy().confirmed);
  simulated_->clear_faults();
  EXPECT_TRUE(until(false));
}

TEST_P(ProfileTest, PowerCycleIsALossAndAReturn) {
  bring_online();
  simulated_->power_off();
  loop_.advance(3s);
  EXPECT_FALSE(drive_->status().online);
  EXPECT_TRUE(drive_->alarm(alarms::AlarmKind::heartbeat).active);
  EXPECT_FALSE(all_tpdo_values_fresh());
  simulated_->power_on();
  ASSERT_TRUE(loop_.advance_until([&] { return drive_->status().online; }, 10s));
  loop_.advance(2s);
  EXPECT_TRUE(all_tpdo_values_fresh());
  EXPECT_FALSE(drive_->alarm(alarms::AlarmKind::heartbeat).active);
  EXPECT_EQ(simulated_->record().rpdo_total(), 0U);
}

INSTANTIATE_TEST_SUITE_P(Shipped, ProfileTest,
                         testing::Values(Kind{"veichi-ac300", 0x0004, "Overcurrent during acceleration"},
                                         Kind{"veichi-ac310", 0x0005, "Overcurrent during acceleration"},
                                         Kind{"invt-goodrive600", 1, "OUt1"}, Kind{"vacon-opte6", 17, "drive fault 17"},
                                         Kind{"cia402-velocity", 0x2310, "Continuous overcurrent"}),
                         name_of_case);

/// The one drive whose codes the simulator obeys as the sibling series do: 1 forward, 5 stop, 7 fault reset.
class Ac300Test : public ProfileTest {
 protected:
  Outcome write(std::vector<FieldWrite> fields) {
    const auto written = support::spawn(
        loop_.executor(),
        drive_->write({.writer = {.way = Writer::Way::modbus, .address = "192.0.2.7"}}, std::move(fields)));
    loop_.advance(50ms);
    EXPECT_TRUE(written.done());
    return written.done() ? written.get() : Outcome(canopen::Error{});
  }
  [[nodiscard]] FieldWrite field(std::string_view name, double value) const {
    return {test::id(model_.drives[0], name), value};
  }
  [[nodiscard]] bool running() const { return drive_->image().raw(test::id(model_.drives[0], "running")) != 0; }
};

TEST_P(Ac300Test, MotorThatFaultedDoesNotStartWithTheNextSetPoint) {
  bring_online();
  ASSERT_TRUE(
      write({field("control_command", 1), field("frequency_command", 20.0), field("torque_command", 0.0)}).has_value());
  loop_.advance(3s);
  ASSERT_TRUE(running());
  const auto run_commands = [&] { return simulated_->record().run_commands; };
  const auto after_start = run_commands();
  ASSERT_TRUE(write({field("frequency_command", 30.0)}).has_value());
  EXPECT_GT(run_commands(), after_start) << "while it runs the run command rides along";

  simulated_->fault(GetParam().fault);
  loop_.advance(2s);
  simulated_->clear_faults();
  loop_.advance(10s);
  ASSERT_FALSE(running());
  const auto after_fault = run_commands();
  ASSERT_TRUE(write({field("frequency_command", 25.0)}).has_value());
  ASSERT_TRUE(write({field("torque_command", 1.0)}).has_value());
  loop_.advance(5s);
  EXPECT_EQ(run_commands(), after_fault);
  EXPECT_FALSE(running());
}

INSTANTIATE_TEST_SUITE_P(Shipped, Ac300Test,
                         testing::Values(Kind{"veichi-ac300", 0x0004, "Overcurrent during acceleration"}));

/// Another master has set the drive up for life guarding and went away: it runs, and nothing but its answers tells.
class LifeGuardedTest : public ProfileTest {
 protected:
  void SetUp() override { master_->open(deaf_); }
  void TearDown() override { master_->close(); }

  void write(std::uint8_t command, std::uint16_t index, std::uint8_t sub, std::uint16_t value) {
    const std::array<std::uint8_t, 8> bytes{command, low(index), high(index), sub, low(value), high(value), 0, 0};
    static_cast<void>(master_->send(canopen::make_frame(0x605, bytes)));
    loop_.advance(5ms);
  }
  void run_with_life_guarding() {
    constexpr std::uint8_t kTwoBytes = 0x2B;
    constexpr std::uint8_t kOneByte = 0x2F;
    simulated_->power_on();
    loop_.advance(100ms);
    write(kTwoBytes, 0x100C, 0, 500);
    write(kOneByte, 0x100D, 0, 3);
    for (std::uint16_t tpdo = 0x1801; tpdo <= 0x1803; ++tpdo) {  // Only after RPDOs, so never.
      write(kOneByte, tpdo, 2, 255);
      write(kTwoBytes, tpdo, 5, 0);
    }
    static_cast<void>(master_->send(canopen::make_frame(0, std::array<std::uint8_t, 2>{1, 5})));
    loop_.advance(5ms);
    write(kTwoBytes, 0x2100, 3, 3000);
    write(kTwoBytes, 0x2101, 0, 1);
    loop_.advance(20s);
  }
  [[nodiscard]] bool runs() const { return simulated_->state() == simulator::NmtState::operational; }

 private:
  static std::uint8_t low(std::uint16_t word) { return static_cast<std::uint8_t>(word); }
  static std::uint8_t high(std::uint16_t word) { return static_cast<std::uint8_t>(word >> 8U); }

  struct Deaf final : canopen::LinkEvents {
    void on_frames(std::span<const canopen::Received>) override {}
    void on_echo(const canopen::Received&) override {}
    void on_bus_state(const canopen::BusState&) override {}
    void on_frames_lost(std::uint32_t) override {}
  };
  Deaf deaf_;
  std::unique_ptr<canopen::Link> master_ = wire_.connect();
};

TEST_P(LifeGuardedTest, FindingItDoesNotStartItsLifeGuarding) {
  run_with_life_guarding();
  ASSERT_TRUE(runs() && simulated_->motor().output_on()) << simulated_->describe();
  start();
  loop_.advance(30s);
  EXPECT_TRUE(runs()) << simulated_->describe();
  EXPECT_FALSE(emcy().active) << emcy().text;
  EXPECT_TRUE(simulated_->motor().output_on()) << simulated_->describe();
  EXPECT_EQ(drive_->status().boot_result, canopen::BootResult::left_alone) << drive_->status().boot_text;
}

INSTANTIATE_TEST_SUITE_P(Shipped, LifeGuardedTest, testing::Values(Kind{"invt-goodrive600", 0, ""}));

}  // namespace
}  // namespace process
