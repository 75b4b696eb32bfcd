#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>

#include <array>
#include <cerrno>
#include <functional>
#include <string>
#include <vector>

#include "canopen/bus/socketcan/raw_socket.h"
#include "daemon/doctor/files.h"
#include "daemon/doctor/hearing.h"
#include "daemon/doctor/interface.h"
#include "daemon/doctor/machine.h"
#include "tests/unit/daemon/doctor_lines.h"

namespace gateway::doctor {
namespace {

using namespace std::chrono_literals;
using canopen::BusCondition;

MachineFacts good_machine() {
  return {.can = {},
          .rmem_max = canopen::socketcan::kWantedReceiveBuffer,
          .now = canopen::WallTime(std::chrono::sys_days(std::chrono::year(2026) / 1 / 2)),
          .clock_synchronised = true};
}

TEST(DoctorTest, AGoodMachine) {
  EXPECT_FALSE(has_error(judge(good_machine())));
  EXPECT_NE(to_text(judge(good_machine())).find("0 errors, 0 warnings"), std::string::npos);
}

TEST(DoctorTest, ABadMachine) {
  MachineFacts facts = good_machine();
  facts.can = error_of(std::errc::address_family_not_supported);
  EXPECT_EQ(find(judge(facts), "no CAN sockets"), "error");
  facts.can = error_of(std::errc::permission_denied);
  EXPECT_EQ(find(judge(facts), "no CAN socket can be opened: Permission denied"), "error");
  facts.rmem_max = 212992;
  EXPECT_EQ(find(judge(facts), "rmem_max is 212992: frames may be lost"), "warning");
  facts.rmem_max.reset();
  EXPECT_EQ(find(judge(facts), "rmem_max cannot be read"), "warning");
  facts.clock_synchronised = false;
  EXPECT_EQ(find(judge(facts), "no time server"), "warning");
  facts.now = {};
  EXPECT_EQ(find(judge(facts), "nobody has set it"), "warning");
}

config::Bus example_bus() {
  config::Bus bus;
  bus.name = "can0";
  bus.interface = "can1";
  bus.bitrate = 250000;
  return bus;
}

InterfaceFacts good_interface() {
  InterfaceFacts facts;
  facts.interface.emplace();
  facts.interface->administratively_up = true;
  facts.interface->carrier = true;
  facts.interface->echoes = true;
  facts.interface->condition = BusCondition::error_active;
  facts.interface->timing = {.bitrate = 250000, .sample_point = 875, .restart_ms = 100};
  facts.driver = "gs_usb";
  return facts;
}

TEST(DoctorTest, AGoodInterface) {
  const Lines lines = judge(example_bus(), good_interface());
  EXPECT_EQ(find(lines, "250000 bit/s, sample point 87.5 %, restart-ms 100"), "ok");
  for (const Line& line : lines) {
    EXPECT_EQ(line.verdict, Verdict::ok) << line.finding;
  }
}

TEST(DoctorTest, BadInterfaces) {
  struct Case {
    const char* what;
    std::function<void(InterfaceFacts&)> spoil;
    const char* finding;
    const char* verdict;
  };
  const std::vector<Case> cases{
      {"no adapter", [](auto& facts) { facts.interface.reset(); }, "no interface can1, and no other", "error"},
      {"another name",
       [](auto& facts) {
         facts.interface.reset();
         facts.others = {"can0", "vcan0"};
       },
       "those of CAN are can0, vcan0", "error"},
      {"no answer", [](auto& facts) { facts.error = error_of(std::errc::permission_denied); },
       "the kernel does not tell", "error"},
      {"Ethernet", [](auto& facts) { facts.is_can = false; }, "can1 is no CAN interface", "error"},
      {"switched off", [](auto& facts) { facts.interface->administratively_up = false; }, "can1 is down", "error"},
      {"bus-off", [](auto& facts) { facts.interface->condition = BusCondition::bus_off; }, "can1 is bus-off", "error"},
      {"error-passive",
       [](auto& facts) {
         facts.interface->condition = BusCondition::passive;
         facts.interface->counters = {128, 3};
       },
       "transmit errors 128, receive errors 3", "warning"},
      {"two bit rates", [](auto& facts) { facts.interface->timing->bitrate = 500000; }, "runs at 500000 bit/s",
       "warning"},
      {"sample point", [](auto& facts) { facts.interface->timing->sample_point = 500; }, "sample point of 50 %",
       "warning"},
      {"restart-ms", [](auto& facts) { facts.interface->timing->restart_ms = 0; }, "restart-ms is 0", "warning"},
      {"no echo", [](auto& facts) { facts.interface->echoes = false; }, "not told when a frame has left", "warning"},
      {"echo of the adapter", [](auto& facts) { facts.driver = "peak_usb"; }, "peak_usb confirms", "warning"}};
  for (const Case& each : cases) {
    InterfaceFacts facts = good_interface();
    each.spoil(facts);
    EXPECT_EQ(find(judge(example_bus(), facts), each.finding), each.verdict) << each.what;
  }
  InterfaceFacts quiet = good_interface();
  quiet.interface->timing.reset();
  config::Bus unknown_rate = example_bus();
  unknown_rate.bitrate.reset();
  EXPECT_EQ(find(judge(unknown_rate, quiet), "tells no bit rate"), "warning");
}

config::Model example_model() {
  config::Model model;
  model.buses = {example_bus()};
  for (const std::uint8_t node : {std::uint8_t{3}, std::uint8_t{5}}) {
    config::Drive drive;
    drive.name = "pump" + std::to_string(node);
    drive.node.node = node;
    model.drives.push_back(drive);
  }
  return model;
}

Lines heard(const std::vector<std::uint32_t>& ids, Presence gateway = Presence::absent) {
  Hearing hearing;
  for (const std::uint32_t id : ids) {
    hearing.add(canopen::make_frame(id, std::array<std::uint8_t, 1>{5}));
  }
  return judge(example_model(), 0, hearing, {.time = 3s, .gateway = gateway});
}

TEST(DoctorTest, WhatIsHeardIsComparedWithTheConfiguration) {
  EXPECT_EQ(find(heard({0x703, 0x185}), "2 frames in 3.0 s, all 2 drives heard"), "ok");
  EXPECT_EQ(heard({0x703, 0x185}).size(), 1U);
  EXPECT_EQ(find(heard({}), "nothing was heard in 3.0 s"), "warning");
  EXPECT_EQ(find(heard({0x703}), "not heard in 3.0 s: pump5 (node 5)"), "warning");
  EXPECT_EQ(find(heard({0x703, 0x705, 0x48C}), "not in the configuration: node 12"), "warning");
  EXPECT_EQ(find(heard({0x703, 0x705, 0x77F}), "somebody else has the gateway's node id 127"), "error");
  EXPECT_EQ(find(heard({0x703, 0x705, 0x000, 0x080, 0x603}), "NMT commands, SYNC, SDO requests to node 3"), "warning");
  EXPECT_EQ(heard({0x703, 0x705, 0x77F, 0x000, 0x603}, Presence::runs).size(), 1U) << "it is the gateway itself";
}

TEST(DoctorTest, NobodyIsAccusedWhereItIsNotKnownWhetherTheGatewayRuns) {
  const Lines lines = heard({0x703, 0x705, 0x77F, 0x080, 0x603}, Presence::unknown);
  ASSERT_EQ(lines.size(), 2U) << to_text(lines);
  EXPECT_EQ(find(lines, "heard: SYNC, SDO requests to node 3, node id 127; from the gateway or from somebody else"),
            "warning");
  EXPECT_EQ(heard({0x703, 0x705}, Presence::unknown).size(), 1U) << "nothing that anybody could have sent";
}

TEST(DoctorTest, WhatAMasterSendsIsNoSignOfTheDrive) {
  EXPECT_EQ(find(heard({0x203, 0x603, 0x303}), "not heard in 3.0 s: pump3 (node 3), pump5 (node 5)"), "warning");
}

TEST(DoctorTest, ErrorsRemoteAndLongFramesAreNobodys) {
  Hearing hearing;
  for (const auto flag : {&canopen::Frame::error, &canopen::Frame::remote, &canopen::Frame::extended}) {
    canopen::Frame frame = canopen::make_frame(0x703, {});
    frame.*flag = true;
    hearing.add(frame);
  }
  hearing.add({.id = 0xFFFFFFFF});
  EXPECT_FALSE(hearing.nodes.at(3));
  const Lines lines = judge(example_model(), 0, hearing, {.time = 3s});
  EXPECT_EQ(find(lines, "the driver told of"), to_text(lines)) << "it told of none on the wire";
}

TEST(DoctorTest, AChangeOfTheControllersStateIsNoErrorOfTheWire) {
  Hearing hearing;
  canopen::Frame state = canopen::make_frame(CAN_ERR_CRTL, std::array<std::uint8_t, 8>{0, CAN_ERR_CRTL_ACTIVE});
  state.error = true;
  hearing.add(state);
  EXPECT_EQ(hearing.errors, 0U);
  state.id = CAN_ERR_ACK;
  hearing.add(state);
  EXPECT_EQ(hearing.errors, 1U);
}

TEST(DoctorTest, ItListensAsLongAsADriveMayBeSilent) {
  config::Model model = example_model();
  EXPECT_EQ(listening_time(model, 0), 3s);
  model.drives[1].node.error_control.heartbeat_timeout = 12s;
  EXPECT_EQ(listening_time(model, 0), 12s);
  EXPECT_EQ(listening_time(model, 1), 3s) << "it is on the other bus";
  model.drives[0].node.error_control.heartbeat_timeout = 100s;
  EXPECT_EQ(listening_time(model, 0), 60s);
}

TEST(DoctorTest, WhatHasNoControllerIsSwitchedOnWithoutABitRate) {
  InterfaceFacts facts = good_interface();
  facts.interface->administratively_up = false;
  EXPECT_NE(judge(example_bus(), facts).front().remedy.find("type can bitrate 250000"), std::string::npos);
  facts.interface->condition.reset();
  EXPECT_EQ(judge(example_bus(), facts).front().remedy, "`ip link set can1 up`");
}

TEST(DoctorTest, ADriveOutOfServiceIsNotMissed) {
  config::Model model = example_model();
  model.drives[1].enabled = false;
  Hearing hearing;
  hearing.add(canopen::make_frame(0x703, {}));
  EXPECT_EQ(find(judge(model, 0, hearing, {.time = 3s}), "all 1 drives heard"), "ok");
  model.drives[0].enabled = false;
  EXPECT_EQ(find(judge(model, 0, hearing, {.time = 3s}), "no drive is configured here"), "ok");
}

TEST(DoctorTest, Files) {
  const std::vector<Wanted> wanted{{"/etc/a", Wanted::Use::read}, {"/var/b", Wanted::Use::keep}};
  const auto facts = [](std::vector<int> errors, bool is_service_user = true) {
    return FileFacts{is_service_user ? kServiceUser : "anna", is_service_user, std::move(errors)};
  };
  EXPECT_EQ(find(judge(wanted, facts({0, 0})), "may use all 2"), "ok");
  EXPECT_EQ(find(judge(wanted, facts({EACCES, 0})), "may not read it: Permission denied"), "error");
  EXPECT_EQ(find(judge(wanted, facts({0, ENOENT})), "may not write to it: No such file"), "error");
  EXPECT_EQ(find(judge(wanted, facts({0, EROFS})), "Read-only file system"), "error");
  EXPECT_EQ(find(judge(wanted, facts({0, 0}, false)), "tried as anna"), "warning");
  EXPECT_EQ(find(judge(wanted, facts({})), "could not be tried"), "warning");
}

TEST(DoctorTest, ASecretThatIsAbsentMayBeACredentialOfTheService) {
  config::Model model;
  model.mqtt.emplace();
  model.gateway.state_dir.clear();
  model.mqtt->password_file = "/etc/x/mqtt-password";
  model.mqtt->key_file = "/etc/x/line3.key";
  const std::vector<Wanted> wanted = wanted_files(model, "/etc/x/gateway.toml", {});
  ASSERT_EQ(wanted.size(), 3U);
  const auto facts = [](std::vector<int> errors) { return FileFacts{kServiceUser, true, std::move(errors)}; };
  const Lines lines = judge(wanted, facts({0, ENOENT, 0}));
  EXPECT_EQ(find(lines, "a credential of the service?"), "warning");
  EXPECT_FALSE(has_error(lines));
  EXPECT_EQ(find(judge(wanted, facts({0, EACCES, 0})), "may not read it: Permission denied"), "error");
  EXPECT_EQ(find(judge(wanted, facts({ENOENT, 0, 0})), "may not read it: No such file"), "error")
      << "the configuration itself";
  EXPECT_EQ(judge(wanted, facts({0, EACCES, 0})).front().remedy.find("chgrp"), std::string::npos)
      << "a secret is not for the group that people join";
  EXPECT_FALSE(lacks_credential(wanted, facts({0, ENOENT, 0}), {"/etc/x/line3.key"})) << "the password is not of TLS";
  EXPECT_TRUE(lacks_credential(wanted, facts({0, 0, ENOENT}), {"/etc/x/ca.pem", "/etc/x/line3.key"}));
  EXPECT_FALSE(lacks_credential(wanted, facts({0, 0, EACCES}), {"/etc/x/line3.key"}));
  EXPECT_FALSE(lacks_credential(wanted, facts({}), {"/etc/x/line3.key"})) << "nothing could be tried";
}

}  // namespace
}  // namespace gateway::doctor
