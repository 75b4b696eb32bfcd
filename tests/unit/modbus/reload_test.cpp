// What clients find when the plant's configuration changes while it runs.

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <utility>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::frame;
using modbus_test::kControlObject;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint8_t kFanUnit = 6;
constexpr std::uint8_t kFanNode = 6;
constexpr std::uint8_t kFlatUnit = 20;
constexpr std::uint8_t kGateway = 0;
constexpr const char* kConfigured = "03 0001 0001";
constexpr const char* kValue = "03 0002 0001";  ///< The output frequency.
constexpr const char* kNmtRegister = "03 03fc 0001";
constexpr const char* kSlowWrite = "06 012c 0001";
constexpr const char* kStopRequest = "06 0064 0005";
constexpr const char* kUnknownUnit = "83 0a";

config::Model pump_alone() {
  config::Model model = example_model();
  model.modbus->flat_unit = kFlatUnit;
  canopen::MotorSigns& motor = model.drives[0].node.motor;
  motor.control = kControlObject;
  motor.stops = {{0xFFFF, 5}};
  return model;
}

/// A drive of the same kind that is not on the bus.
config::Drive fan() {
  config::Drive drive = pump_alone().drives[0];
  drive.name = "fan1";
  drive.unit = kFanUnit;
  drive.node.node = kFanNode;
  for (canopen::PdoSettings& pdo : drive.node.tpdos) {
    ++pdo.cob_id;
  }
  ++drive.node.rpdos[0].cob_id;
  return drive;
}

/// One that needs no PDO.
config::Drive simple_fan(const std::string& name) {
  config::Drive drive = fan();
  drive.name = name;
  drive.node.tpdos.clear();
  drive.node.rpdos.clear();
  for (config::Signal& signal : drive.signals) {
    signal.source = {};
  }
  return drive;
}

/// `fan1` stands before `pump1`.
config::Model fan_and_pump() {
  config::Model model = pump_alone();
  model.drives.insert(model.drives.begin(), fan());
  return model;
}

class Reload : public testing::Test {
 protected:
  explicit Reload(config::Model model = pump_alone()) : site_(std::move(model)) {}
  void begin() {
    site_.bring_up();
    site_.send_values(0, 0x1388, 0);
  }
  void change(config::Model model) {
    site_.change(std::move(model));
    site_.loop().advance(milliseconds(1));
  }
  std::string ask(std::uint8_t unit, const char* pdu) { return site_.ask(site_.client(), unit, pdu); }
  void send(std::uint8_t unit, const char* pdu) {
    const auto request = frame(unit, pdu);
    ASSERT_EQ(site_.client().send(request), request.size());
    site_.settle();
  }

  /// The fan that the second drive is; longer than a write may take.
  void bring_up_fan(support::Puppet& there) {
    there.boot_up();
    for (milliseconds passed{}; passed < seconds(3); passed += milliseconds(50)) {
      there.heartbeat();
      site_.run_without_values(milliseconds(50));
    }
    EXPECT_TRUE(site_.plant().drive(1).status().online) << site_.plant().drive(1).status().boot_text;
  }

  Site site_;
};

TEST_F(Reload, AConnectionStaysAndSoDoesTheUnitOfADriveThatStays) {
  begin();
  EXPECT_EQ(ask(kUnit, "06 03fc 0001"), "06 03fc 0001");
  EXPECT_EQ(ask(kUnit, kValue), "03 02 1388");
  EXPECT_EQ(ask(kFanUnit, kValue), kUnknownUnit);
  change(fan_and_pump());
  EXPECT_EQ(ask(kUnit, kValue), "03 02 1388");
  EXPECT_EQ(ask(kUnit, kNmtRegister), "03 02 0001");
  EXPECT_EQ(ask(kFanUnit, "03 03e8 0001"), "03 02 0000") << "offline";
  EXPECT_EQ(ask(kGateway, kConfigured), "03 02 0002");
  site_.send_values(0, 0x0102, 0);
  EXPECT_EQ(ask(kUnit, kValue), "03 02 0102") << "its values go to its own unit";
  EXPECT_EQ(ask(kUnit, "06 012c 0007"), "06 012c 0007");
  EXPECT_EQ(site_.server().clients(), 1U);
  EXPECT_EQ(site_.noticed("disconnected"), 0U);
}

TEST_F(Reload, AUnitThatGoesIsUnknown) {
  begin();
  change(fan_and_pump());
  config::Model model = pump_alone();
  model.drives = {fan()};
  change(model);
  EXPECT_EQ(ask(kUnit, kValue), kUnknownUnit);
  EXPECT_EQ(ask(kUnit, "2b 0e 01 00"), "ab 0a");
  EXPECT_EQ(ask(kFanUnit, "03 03e8 0001"), "03 02 0000");
  EXPECT_EQ(ask(kGateway, kConfigured), "03 02 0001");
}

/// `pump1` on the second of two buses.
config::Model on_the_second_bus() {
  config::Model model = pump_alone();
  config::Bus first = model.buses[0];
  first.name = "hall";
  model.buses.insert(model.buses.begin(), first);
  model.drives[0].bus = 1;
  return model;
}

class ReloadOfBuses : public Reload {
 protected:
  ReloadOfBuses() : Reload(on_the_second_bus()) {}
};

TEST_F(ReloadOfBuses, TheIdentityOfADriveNamesTheBusWhereItIsNow) {
  constexpr const char* kProductName = "2b 0e 04 04";
  begin();
  const process::Drive* const pump = &site_.plant().drive(0);
  const std::string before = ask(kUnit, kProductName);
  ASSERT_EQ(before.find("2b"), 0U) << before;
  change(pump_alone());  // The first bus is removed.
  ASSERT_EQ(&site_.plant().drive(0), pump);
  EXPECT_EQ(ask(kUnit, kProductName), before);
}

TEST_F(Reload, TheFlatUnitFollows) {
  config::Model model = pump_alone();
  model.drives.push_back(fan());
  model.drives[0].flat = 3000;
  model.drives[1].flat = 4000;
  begin();
  EXPECT_EQ(ask(kFlatUnit, "03 0bba 0001"), "83 02");
  change(model);
  site_.bring_up();
  site_.send_values(0, 0x1388, 0);
  EXPECT_EQ(ask(kFlatUnit, "03 0bba 0001"), "03 02 1388") << "3002";
  EXPECT_EQ(ask(kFlatUnit, "03 1324 0001"), "03 02 0000") << "4900: the fan is offline";
  change(pump_alone());
  EXPECT_EQ(ask(kFlatUnit, "03 1324 0001"), "83 02");
}

TEST_F(Reload, AWriteUnderWayOfADriveThatGoesIsAnswered) {
  begin();
  site_.puppet().mute = true;
  send(kUnit, kSlowWrite);
  config::Model model = pump_alone();
  model.drives = {fan()};
  change(model);
  EXPECT_EQ(site_.answer(site_.client()), "86 0b");
  EXPECT_EQ(ask(kGateway, kConfigured), "03 02 0001") << "the same connection";
}

TEST_F(Reload, AWriteUnderWayOfADriveThatStaysIsConfirmed) {
  begin();
  site_.puppet().mute = true;
  send(kUnit, kSlowWrite);
  site_.puppet().mute = false;
  change(fan_and_pump());
  site_.run(seconds(3));
  EXPECT_EQ(site_.answer(site_.client()), "86 0b") << "what the drive did not hear";
  EXPECT_EQ(ask(kUnit, kSlowWrite), kSlowWrite);
}

TEST_F(Reload, WhatCameBeforeAUnitWasAnotherDrivesIsNotCarriedOutThere) {
  begin();
  support::Puppet there(site_.can(), kFanNode);
  modbus_test::fill_dictionary(there);
  config::Model model = pump_alone();
  model.drives.push_back(simple_fan("fan1"));
  change(model);
  bring_up_fan(there);
  EXPECT_EQ(ask(kFanUnit, kSlowWrite), kSlowWrite) << "as it should be";
  site_.puppet().mute = true;
  send(kUnit, kSlowWrite);
  send(kFanUnit, kSlowWrite);
  model.drives[1] = simple_fan("fan2");
  change(model);
  there.written.clear();
  bring_up_fan(there);
  EXPECT_EQ(site_.answer(site_.client()), "86 0b") << "what the pump did not answer";
  EXPECT_EQ(site_.answer(site_.client()), "86 0b") << "what was meant for fan1";
  EXPECT_TRUE(there.written.empty());
  EXPECT_EQ(ask(kFanUnit, kSlowWrite), kSlowWrite) << "it is asked for again";
}

TEST_F(Reload, AStopUnderWayThatOvertookAWriteIsAnsweredAndTheConnectionServesOn) {
  begin();
  site_.puppet().mute = true;
  auto requests = frame(kUnit, kSlowWrite);
  const auto stop = frame(kUnit, kStopRequest);
  requests.insert(requests.end(), stop.begin(), stop.end());
  ASSERT_EQ(site_.client().send(requests), requests.size());
  site_.settle();
  config::Model model = pump_alone();
  model.drives = {fan()};
  change(model);
  EXPECT_EQ(site_.answer(site_.client()), "86 0b");
  EXPECT_EQ(site_.answer(site_.client()), "86 0b");
  change(pump_alone());
  site_.puppet().mute = false;
  site_.bring_up();
  EXPECT_EQ(ask(kUnit, kSlowWrite), kSlowWrite) << "older than no stop";
}

TEST_F(Reload, TheFirstFaultIsStillThatOfItsDrive) {
  begin();
  site_.send_values(0x0008, 0, 0);
  site_.run(milliseconds(100));
  ASSERT_EQ(ask(kUnit, "03 03f8 0001"), "03 02 0001");
  change(fan_and_pump());
  EXPECT_EQ(ask(kUnit, "03 03f8 0001"), "03 02 0001");
  EXPECT_EQ(ask(kFanUnit, "03 03f8 0001"), "03 02 0000");
}

}  // namespace
