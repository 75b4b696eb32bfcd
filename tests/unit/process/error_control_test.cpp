// Error control against a simulated Goodrive600: by guarding, by none at all, and where another master has armed life
// guarding.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "bridges/process/drive.h"
#include "canopen/bus/bus.h"
#include "canopen/bus/virtual_link.h"
#include "config/load.h"
#include "simulator/drive.h"
#include "simulator/network.h"
#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace process {
namespace {

using namespace std::chrono_literals;

/// Sees all frames of the bus, and counts the guarding requests among them.
class RequestCounter final : private canopen::LinkEvents {
 public:
  explicit RequestCounter(canopen::VirtualBus& bus) : link_(bus.connect()) { link_->open(*this); }
  ~RequestCounter() { link_->close(); }
  RequestCounter(const RequestCounter&) = delete;
  RequestCounter& operator=(const RequestCounter&) = delete;

  [[nodiscard]] int requests() const noexcept { return requests_; }
  void forget() noexcept { requests_ = 0; }

 private:
  void on_frames(std::span<const canopen::Received> frames) override {
    requests_ += static_cast<int>(
        std::count_if(frames.begin(), frames.end(), [](const auto& received) { return received.frame.remote; }));
  }
  void on_echo(const canopen::Received&) override {}
  void on_bus_state(const canopen::BusState&) override {}
  void on_frames_lost(std::uint32_t) override {}

  std::unique_ptr<canopen::Link> link_;
  int requests_ = 0;
};

class ErrorControlTest : public testing::Test {
 protected:
  ErrorControlTest() {
    bus_.start();
    network_.open();
  }
  ~ErrorControlTest() override {
    stop();
    const auto stopped = support::spawn(loop_.executor(), bus_.stop());
    loop_.settle();
    EXPECT_TRUE(*stopped);
  }

  void load(const std::string& keys) {
    const std::string site =
        "[[bus]]\nname = \"can0\"\ninterface = \"virtual\"\n"
        "[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"invt-goodrive600\"\n" +
        keys + "[drive.commands]\nwriters = [\"modbus\"]\n";
    const config::Loaded loaded =
        config::load_text(site, {"site.toml", {GATEWAY_SOURCE_DIR "/config/profiles"}, "host"});
    if (!loaded.model) {
      throw std::runtime_error("the site does not load");
    }
    model_ = *loaded.model;
  }
  void make_drive(const simulator::DriveOptions& options = {}) {
    simulated_ = simulator::make_drive("invt-goodrive600", 5, network_, options);
  }
  /// Its heartbeat time cannot be set: guarding is all there is.
  void make_drive_with_guarding_only(const simulator::DriveOptions& options = {}) {
    make_drive(options);
    simulated_->misbehaviour().absent = {{0x1017, std::nullopt}};
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
    ASSERT_TRUE(wait_online()) << drive_->status().boot_text;
    loop_.advance(3s);
  }
  [[nodiscard]] bool wait_online() {
    return loop_.advance_until([&] { return drive_->status().online; }, 15s);
  }
  [[nodiscard]] const canopen::NodeStatus& status() const { return drive_->status(); }
  [[nodiscard]] const alarms::Alarm& alarm(alarms::AlarmKind kind) const { return drive_->alarm(kind); }
  [[nodiscard]] bool all_tpdo_values_fresh() const {
    const auto sources = drive_->image().sources();
    return std::ranges::all_of(sources, [](const SourceState& source) {
      return source.source.kind != config::SourceKind::tpdo || source.fresh(canopen::Clock::now());
    });
  }
  [[nodiscard]] canopen::Duration age() const { return canopen::Clock::now() - *status().last_heartbeat; }
  /// It runs, told so by a master that is gone since, and sends no TPDO by itself.
  void run_without_tpdos() {
    simulated_->power_on();
    loop_.advance(100ms);
    for (const std::uint8_t low : {std::uint8_t{0x01}, std::uint8_t{0x02}, std::uint8_t{0x03}}) {
      tell(0x605, {0x2F, low, 0x18, 2, 255, 0, 0, 0});
      tell(0x605, {0x2B, low, 0x18, 5, 0, 0, 0, 0});
    }
    tell(0, {1, 5});
    tell(0x605, {0x2B, 0x00, 0x21, 3, 0xB8, 0x0B, 0, 0});
    tell(0x605, {0x2B, 0x01, 0x21, 0, 1, 0, 0, 0});
    loop_.advance(20s);
    ASSERT_TRUE(simulated_->motor().output_on()) << simulated_->describe();
  }
  void tell(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
    other_master_.send(id, bytes);
    loop_.advance(5ms);
  }

  struct OtherMaster final : canopen::LinkEvents {
    explicit OtherMaster(canopen::VirtualBus& bus) : link(bus.connect()) { link->open(*this); }
    ~OtherMaster() { link->close(); }
    OtherMaster(const OtherMaster&) = delete;
    OtherMaster& operator=(const OtherMaster&) = delete;
    void send(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
      static_cast<void>(link->send(canopen::make_frame(id, std::span(bytes.begin(), bytes.size()))));
    }
    void on_frames(std::span<const canopen::Received>) override {}
    void on_echo(const canopen::Received&) override {}
    void on_bus_state(const canopen::BusState&) override {}
    void on_frames_lost(std::uint32_t) override {}
    std::unique_ptr<canopen::Link> link;
  };

  support::HandDrivenLoop loop_;
  canopen::VirtualBus wire_{loop_.executor()};
  canopen::Bus bus_{loop_.executor(), wire_.connect(), {}};
  simulator::Network network_{loop_.executor(), wire_.connect()};
  RequestCounter counter_{wire_};
  OtherMaster other_master_{wire_};
  std::unique_ptr<simulator::Drive> simulated_;
  config::Model model_;
  std::vector<Observer*> observers_;
  std::unique_ptr<Drive> drive_;
};

constexpr const char* kGuarded = "guarding = \"500ms\"\n";
constexpr const char* kWithout = "heartbeat = \"0s\"\n";

TEST_F(ErrorControlTest, WithGuardingOnlyItIsBootedAndItsValuesAreFresh) {
  load(kGuarded);
  make_drive_with_guarding_only();
  bring_online();
  counter_.forget();
  loop_.advance(10s);
  EXPECT_EQ(counter_.requests(), 20);
  EXPECT_TRUE(all_tpdo_values_fresh());
  EXPECT_EQ(status().nmt, canopen::NmtState::operational);
  EXPECT_LE(age(), 500ms);
  for (const alarms::AlarmKind kind : alarms::kAlarmKinds) {
    EXPECT_FALSE(alarm(kind).active) << name_of(kind) << ": " << alarm(kind).text;
  }
  EXPECT_EQ(simulated_->record().rpdo_total(), 0U);
}

TEST_F(ErrorControlTest, ItsSilenceIsALossAndItComesBack) {
  load(kGuarded);
  make_drive_with_guarding_only();
  bring_online();
  simulated_->misbehaviour().unplugged = true;
  loop_.advance(3s);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(alarm(alarms::AlarmKind::heartbeat).active);
  EXPECT_EQ(alarm(alarms::AlarmKind::heartbeat).text, "no guarding answer for 1500 ms");
  EXPECT_FALSE(all_tpdo_values_fresh());
  simulated_->misbehaviour().unplugged = false;
  ASSERT_TRUE(wait_online()) << status().boot_text;
  loop_.advance(2s);
  EXPECT_TRUE(all_tpdo_values_fresh());
  EXPECT_FALSE(alarm(alarms::AlarmKind::heartbeat).active);
  EXPECT_EQ(status().heartbeat_losses, 1U);
}

TEST_F(ErrorControlTest, APowerCycleIsABootAgain) {
  load(kGuarded);
  make_drive_with_guarding_only();
  bring_online();
  simulated_->power_off();
  loop_.advance(3s);
  ASSERT_TRUE(alarm(alarms::AlarmKind::heartbeat).active);
  simulated_->power_on();
  ASSERT_TRUE(wait_online()) << status().boot_text;
  loop_.advance(10s);
  EXPECT_TRUE(status().online);
  EXPECT_FALSE(alarm(alarms::AlarmKind::heartbeat).active);
  EXPECT_EQ(simulated_->record().rpdo_total(), 0U);
}

TEST_F(ErrorControlTest, LeavingOperationalByItselfIsTold) {
  load(kGuarded);
  make_drive_with_guarding_only();
  bring_online();
  simulated_->go(simulator::NmtState::pre_operational);
  loop_.advance(1s);
  EXPECT_EQ(status().nmt, canopen::NmtState::pre_operational);
  EXPECT_TRUE(alarm(alarms::AlarmKind::boot).active);
  EXPECT_EQ(alarm(alarms::AlarmKind::boot).reason, "left-operational");
  loop_.advance(10s);
  EXPECT_EQ(simulated_->state(), simulator::NmtState::pre_operational) << "not started again";
}

TEST_F(ErrorControlTest, AToggleBitThatStandsStillIsALoss) {
  load(kGuarded);
  make_drive_with_guarding_only();
  bring_online();
  simulated_->misbehaviour().toggle_stuck = true;
  loop_.advance(4s);
  EXPECT_FALSE(status().online);
  EXPECT_TRUE(alarm(alarms::AlarmKind::heartbeat).active);
  loop_.advance(30s);
  EXPECT_EQ(status().heartbeat_losses, 1U);
  simulated_->misbehaviour().toggle_stuck = false;
  loop_.advance(70s);
  EXPECT_TRUE(status().online) << status().boot_text;
  EXPECT_FALSE(alarm(alarms::AlarmKind::heartbeat).active);
}

TEST_F(ErrorControlTest, WhereAnotherMasterArmedLifeGuardingNotOneRequestLeavesAndItsMotorRunsOn) {
  load(kGuarded);
  simulator::DriveOptions options;
  options.guard_ms = 500;
  options.life_factor = 3;
  make_drive_with_guarding_only(options);
  run_without_tpdos();
  start();
  loop_.advance(90s);
  EXPECT_EQ(counter_.requests(), 0);
  EXPECT_TRUE(simulated_->motor().output_on()) << simulated_->describe();
  EXPECT_EQ(simulated_->state(), simulator::NmtState::operational);
  EXPECT_EQ(simulated_->record().emergencies, 0U);
  EXPECT_EQ(status().boot_result, canopen::BootResult::left_alone) << status().boot_text;
  EXPECT_NE(status().boot_text.find("its motor runs"), std::string::npos) << status().boot_text;
}

TEST_F(ErrorControlTest, WhereItWasArmedBeforeItsBootNotOneRequestLeavesAndTheAlarmSaysWhy) {
  load(kGuarded);
  simulator::DriveOptions options;
  options.guard_ms = 500;
  options.life_factor = 3;
  make_drive_with_guarding_only(options);
  start();
  simulated_->power_on();
  loop_.advance(90s);
  EXPECT_EQ(counter_.requests(), 0);
  EXPECT_EQ(status().boot_result, canopen::BootResult::not_configured) << status().boot_text;
  EXPECT_NE(alarm(alarms::AlarmKind::boot).text.find("another master has set life guarding"), std::string::npos)
      << alarm(alarms::AlarmKind::boot).text;
  EXPECT_EQ(simulated_->record().nmt_command_count, 0U);
}

TEST_F(ErrorControlTest, WithSuperviseGatewayItNoticesOurEnd) {
  load(std::string(kGuarded) + "supervise_gateway = \"1500ms\"\n");
  make_drive_with_guarding_only();
  bring_online();
  loop_.advance(30s);
  EXPECT_EQ(simulated_->record().emergencies, 0U);
  EXPECT_EQ(simulated_->state(), simulator::NmtState::operational);
  stop();
  loop_.advance(900ms);  // The last request was up to 500 ms before our end.
  EXPECT_EQ(simulated_->record().emergencies, 0U);
  loop_.advance(700ms);
  EXPECT_EQ(simulated_->record().emergencies, 1U) << "0x8130";
  EXPECT_EQ(simulated_->state(), simulator::NmtState::pre_operational);
}

TEST_F(ErrorControlTest, WithoutSuperviseGatewayOurEndIsNoMatter) {
  load(kGuarded);
  make_drive_with_guarding_only();
  bring_online();
  stop();
  loop_.advance(30s);
  EXPECT_EQ(simulated_->record().emergencies, 0U);
  EXPECT_EQ(simulated_->state(), simulator::NmtState::operational);
}

TEST_F(ErrorControlTest, WithoutAnyItIsOnlineByItsTpdos) {
  load(kWithout);
  make_drive();
  bring_online();
  loop_.advance(30s);
  EXPECT_TRUE(status().online);
  EXPECT_LE(age(), 110ms);
  EXPECT_EQ(simulated_->record().heartbeats, 0U);
  EXPECT_EQ(counter_.requests(), 0);
  simulated_->misbehaviour().unplugged = true;
  loop_.advance(2s);
  EXPECT_FALSE(status().online);
  EXPECT_EQ(alarm(alarms::AlarmKind::heartbeat).text, "no TPDO and no SDO answer for 1500 ms");
  simulated_->misbehaviour().unplugged = false;
  EXPECT_TRUE(wait_online()) << status().boot_text;
}

TEST_F(ErrorControlTest, WithoutAnyAndWithoutTpdosItIsOnlineBySdo) {
  load(std::string(kWithout) + "tpdo2 = { transmission_type = 255, event_timer = \"0s\" }\n");
  make_drive();
  bring_online();
  for (int i = 0; i < 300; ++i) {
    loop_.advance(100ms);
    ASSERT_TRUE(status().online);
    ASSERT_LE(age(), 550ms);
  }
}

}  // namespace
}  // namespace process
