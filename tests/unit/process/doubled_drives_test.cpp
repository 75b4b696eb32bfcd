// Two simulated drives on one node id, from the start or one later: what the bus alarm says, and that no command but a
// stop goes there. And that one drive which sends far more than its event timer says is none of that.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/unit/process/simulated_bus.h"

namespace process {
namespace {

using namespace std::chrono_literals;
using canopen::Doubled;

constexpr std::uint8_t kNode = 5;
constexpr canopen::Raw kShutdown = 6;
constexpr canopen::Raw kSwitchOn = 7;
constexpr canopen::Raw kRun = 15;

std::string site_of(const std::string& profile) {
  return "[[drive]]\nname = \"pump1\"\nnode = 5\nprofile = \"" + profile +
         "\"\n[drive.commands]\nwriters = [\"modbus\"]\n";
}

simulator::DriveOptions with_serial(std::uint32_t serial) {
  simulator::DriveOptions options;
  options.serial = serial;
  return options;
}

class DoubledDrivesTest : public SimulatedBus {
 protected:
  static constexpr const char* kCia402 = "cia402-velocity";

  /// A drive and a spare of the same kind; neither has power.
  void load_pair(const std::string& kind) {
    load(site_of(kind));
    first_ = &add(kind, kNode, with_serial(1001));
    spare_ = &add(kind, kNode, with_serial(1002));
    start();
  }
  void bring_first_online(const std::string& kind) {
    load_pair(kind);
    first_->power_on();
    ASSERT_TRUE(wait_online()) << status().boot_text;
    run(12s);
    ASSERT_EQ(status().doubled, Doubled::no) << status().doubled_text;
  }
  void run_first() {
    for (const canopen::Raw word : {kShutdown, kSwitchOn, kRun}) {
      ASSERT_TRUE(write({{"control_command", word}, {"target_velocity", 600}}).has_value());
    }
    run(5s);
    ASSERT_EQ(first_->motor().state(), simulator::MotorState::running);
  }
  void expect_proof() {
    EXPECT_TRUE(bus_alarm().active);
    EXPECT_EQ(bus_alarm().reason, "doubled-node-id") << bus_alarm().text;
    EXPECT_EQ(bus_alarm().severity, config::Severity::fault);
    EXPECT_EQ(bus_alarm().text.find("node id 5 of pump1 is used twice: "), 0U) << bus_alarm().text;
  }
  /// Nothing that a person or a program asks for reaches either of them.
  void expect_no_commands() {
    run(2s);  // Whatever was begun.
    neighbour_.forget();
    const std::uint64_t nmt_before = first_->record().nmt_command_count;
    const Outcome refused = write({{"control_command", kRun}});
    ASSERT_TRUE(refused.has_error());
    EXPECT_EQ(refused.error().kind, canopen::ErrorKind::offline);
    EXPECT_NE(canopen::to_string(refused.error()).find("two nodes have its node id"), std::string::npos)
        << canopen::to_string(refused.error());
    EXPECT_TRUE(nmt(canopen::NmtCommand::reset_node).has_error());
    run(1s);
    EXPECT_EQ(neighbour_.heard(0x205), 0U);
    EXPECT_EQ(neighbour_.heard(0x305), 0U);
    EXPECT_EQ(neighbour_.downloads(kNode), 0U);
    EXPECT_EQ(first_->record().nmt_command_count, nmt_before);
    expect_proof();
  }
  /// It goes once, by SDO, to whoever listens.
  void expect_a_stop_to_go() {
    neighbour_.forget();
    static_cast<void>(stop_motor());
    run(2s);
    EXPECT_EQ(neighbour_.downloads(kNode), 1U);
    EXPECT_EQ(neighbour_.heard(0x205), 0U);
  }

  void expect_nothing_raised() {
    EXPECT_FALSE(bus_alarm().active) << bus_alarm().text;
    for (std::size_t i = 0; i < plant_->size(); ++i) {
      const Drive& each = plant_->drive(i);
      EXPECT_EQ(each.status().doubled, Doubled::no) << each.status().doubled_text;
      EXPECT_TRUE(each.status().online) << each.status().boot_text;
      EXPECT_FALSE(each.has_fault_alarm() || each.has_warning_alarm());
    }
  }

  simulator::Drive* first_ = nullptr;
  simulator::Drive* spare_ = nullptr;
};

class DoubledKindsTest : public DoubledDrivesTest, public testing::WithParamInterface<const char*> {};

TEST_P(DoubledKindsTest, TwoFromTheStartAreProvenByTheirBootUps) {
  load_pair(GetParam());
  first_->power_on();
  run(150ms);
  spare_->power_on();
  ASSERT_TRUE(wait_for(Doubled::proof, 1s));
  expect_proof();
  expect_no_commands();
  EXPECT_EQ(first_->record().run_commands + spare_->record().run_commands, 0U);
}

// The two boot-ups may be one frame that CAN has doubled.
TEST_P(DoubledKindsTest, TwoThatWakeUpTogetherAreFoundByWhatTheyAnswer) {
  load_pair(GetParam());
  first_->power_on();
  spare_->power_on();
  ASSERT_TRUE(loop_.advance_until([&] { return status().doubled != Doubled::no; }, 30s)) << status().boot_text;
  EXPECT_TRUE(bus_alarm().active);
  EXPECT_EQ(bus_alarm().reason.find("doubled-node-id"), 0U) << bus_alarm().reason;
  if (first_->dictionary().find({0x1018, 4}) != nullptr) {
    ASSERT_TRUE(wait_for(Doubled::proof, 60s)) << status().doubled_text;
    expect_no_commands();
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, DoubledKindsTest,
                         testing::Values("cia402-velocity", "invt-goodrive600", "vacon-opte6", "veichi-ac310"),
                         [](const auto& parameter) {
                           std::string name = parameter.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST_F(DoubledDrivesTest, ASpareThatComesBesideARunningDriveIsProven) {
  bring_first_online(kCia402);
  run_first();
  spare_->power_on();
  ASSERT_TRUE(wait_for(Doubled::proof, 15s)) << status().doubled_text;
  expect_proof();
  EXPECT_EQ(spare_->record().run_commands, 0U) << "the run command is not for it";
  expect_no_commands();
  expect_a_stop_to_go();
  EXPECT_FALSE(first_->motor().output_on());
}

// Factory settings: no heartbeat, and nobody heard its boot-up. It answers what the first one is asked.
TEST_F(DoubledDrivesTest, ASilentSpareIsFoundWhenItAnswers) {
  bring_first_online(kCia402);
  spare_->misbehaviour().boot_up_missing = true;
  spare_->power_on();
  ASSERT_TRUE(wait_for(Doubled::proof, 70s)) << status().doubled_text;
  expect_proof();
  expect_no_commands();
}

TEST_F(DoubledDrivesTest, ASpareThatSaysPreOperationalBesideAnOperationalDriveIsProven) {
  load(site_of(kCia402));
  first_ = &add(kCia402, kNode, with_serial(1001));
  simulator::DriveOptions options = with_serial(1002);
  options.heartbeat_ms = 500;
  spare_ = &add(kCia402, kNode, options);
  spare_->misbehaviour().boot_up_missing = true;
  start();
  first_->power_on();
  ASSERT_TRUE(wait_online());
  run(5s);
  run_first();
  run(120ms);  // Not in step.
  spare_->power_on();
  ASSERT_TRUE(wait_for(Doubled::proof, 3s)) << status().doubled_text;
  expect_proof();
  expect_no_commands();
  expect_a_stop_to_go();
}

TEST_F(DoubledDrivesTest, ItEndsAMinuteAfterTheSpareWasTakenAway) {
  load_pair(kCia402);
  first_->power_on();
  run(150ms);
  spare_->power_on();
  ASSERT_TRUE(wait_for(Doubled::proof, 1s));
  spare_->power_off();
  loop_.advance(75s, 5ms);
  EXPECT_EQ(status().doubled, Doubled::no) << status().doubled_text;
  EXPECT_FALSE(bus_alarm().active);
  ASSERT_TRUE(status().online) << status().boot_text;
  run_first();
}

// On change each 10 ms, where the event timer says 100 ms.
TEST_F(DoubledDrivesTest, RampingDrivesAtTenTimesTheirRateRaiseNothing) {
  std::string drives;
  for (int i = 0; i < 4; ++i) {
    const std::string number = std::to_string(i + 1);
    drives += "[[drive]]\nname = \"pump" + number + "\"\nnode = " + number +
              "\nprofile = \"cia402-velocity\"\n[drive.commands]\nwriters = [\"modbus\"]\n";
  }
  load(drives);
  for (std::uint8_t node = 1; node <= 4; ++node) {
    add(kCia402, node, with_serial(1000U + node)).power_on();
  }
  start();
  ASSERT_TRUE(wait_online());
  run(3s);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    for (const canopen::Raw word : {kShutdown, kSwitchOn, kRun}) {
      ASSERT_TRUE(write({{"control_command", word}, {"target_velocity", 1500}}, i).has_value());
    }
    drives_[i]->record().tpdos = 0;
  }
  for (int turn = 0; turn < 6; ++turn) {
    for (int step = 0; step < 100; ++step) {
      run(100ms);
      expect_nothing_raised();
    }
    const canopen::Raw target = turn % 2 == 0 ? canopen::normalise(canopen::DataType::i16, 0xFA24) : canopen::Raw{1500};
    for (std::size_t i = 0; i < drives_.size(); ++i) {  // The other way round, through standstill.
      ASSERT_TRUE(write({{"control_command", kRun}, {"target_velocity", target}}, i).has_value());
    }
  }
  for (const auto& simulated : drives_) {
    EXPECT_GE(simulated->record().tpdos, 4000U) << "the event timer alone would have sent 600";
  }
}

}  // namespace
}  // namespace process
