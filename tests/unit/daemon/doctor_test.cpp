#include <gtest/gtest.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <cerrno>
#include <functional>
#include <string>
#include <vector>

#include "canopen/bus/socketcan/raw_socket.h"
#include "daemon/doctor/files.h"
#include "daemon/doctor/hearing.h"
#include "daemon/doctor/interface.h"
#include "daemon/doctor/machine.h"
#include "daemon/doctor/network.h"

namespace gateway::doctor {
namespace {

using namespace std::chrono_literals;
using canopen::BusCondition;

std::error_code error_of(std::errc code) {
  return std::make_error_code(code);
}

// The line that says `part`, as `verdict: finding`; else all there are.
std::string find(const Lines& lines, const std::string& part) {
  for (const Line& line : lines) {
    if (line.finding.find(part) != std::string::npos) {
      EXPECT_EQ(line.remedy.empty(), line.verdict == Verdict::ok) << line.finding;
      return std::string(line.verdict == Verdict::ok ? "ok" : line.verdict == Verdict::warning ? "warning" : "error");
    }
  }
  return to_text(lines);
}

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

Lines heard(const std::vector<std::uint32_t>& ids, bool gateway_runs = false) {
  Hearing hearing;
  for (const std::uint32_t id : ids) {
    hearing.add(canopen::make_frame(id, std::array<std::uint8_t, 1>{5}));
  }
  return judge(example_model(), 0, hearing, {.time = 3s, .gateway_runs = gateway_runs});
}

TEST(DoctorTest, WhatIsHeardIsComparedWithTheConfiguration) {
  EXPECT_EQ(find(heard({0x703, 0x185}), "2 frames in 3.0 s, all 2 drives heard"), "ok");
  EXPECT_EQ(heard({0x703, 0x185}).size(), 1U);
  EXPECT_EQ(find(heard({}), "nothing was heard in 3.0 s"), "warning");
  EXPECT_EQ(find(heard({0x703}), "not heard in 3.0 s: pump5 (node 5)"), "warning");
  EXPECT_EQ(find(heard({0x703, 0x705, 0x48C}), "not in the configuration: node 12"), "warning");
  EXPECT_EQ(find(heard({0x703, 0x705, 0x77F}), "somebody else has the gateway's node id 127"), "error");
  EXPECT_EQ(find(heard({0x703, 0x705, 0x000, 0x080, 0x603}), "NMT commands, SYNC, SDO requests to node 3"), "warning");
  EXPECT_EQ(heard({0x703, 0x705, 0x77F, 0x000, 0x603}, true).size(), 1U) << "it is the gateway itself";
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
  EXPECT_EQ(find(lines, "the driver told of 1 errors"), "warning");
}

TEST(DoctorTest, ADriveOutOfServiceIsNotMissed) {
  config::Model model = example_model();
  model.drives[1].enabled = false;
  Hearing hearing;
  hearing.add(canopen::make_frame(0x703, {}));
  EXPECT_EQ(find(judge(model, 0, hearing, {.time = 3s}), "all 1 drives heard"), "ok");
}

TEST(DoctorTest, Ports) {
  const config::Endpoint port{"0.0.0.0", 502};
  const PortHolder root{.gateway_runs = false, .privileged = true};
  const PortHolder running{.gateway_runs = true, .privileged = true};
  EXPECT_EQ(find({judge(port, {}, root)}, "free"), "ok");
  EXPECT_EQ(find({judge(port, {}, running)}, "does not listen there"), "warning");
  const PortFacts taken{.error = error_of(std::errc::address_in_use)};
  EXPECT_EQ(find({judge(port, taken, root)}, "another program"), "error");
  EXPECT_EQ(find({judge(port, taken, running)}, "in use"), "ok");
  const PortFacts away{.error = error_of(std::errc::address_not_available)};
  EXPECT_EQ(find({judge(port, away, root)}, "does not have that address"), "warning");
  const PortFacts forbidden{.error = error_of(std::errc::permission_denied)};
  EXPECT_EQ(find({judge(port, forbidden, {})}, "only root may try"), "warning");
  EXPECT_EQ(find({judge(port, forbidden, root)}, "Permission denied"), "error");
  EXPECT_EQ(find({judge(port, {.unknown_name = "Host not found"}, root)}, "no address is known for 0.0.0.0"),
            "warning");
}

TEST(DoctorTest, APortThatIsTakenIsSeen) {
  boost::asio::io_context io;
  boost::asio::ip::tcp::acceptor taken(io, {boost::asio::ip::address_v4::loopback(), 0});
  const std::uint16_t port = taken.local_endpoint().port();
  EXPECT_EQ(try_port({"127.0.0.1", port}).error, std::errc::address_in_use);
  taken.close();
  EXPECT_FALSE(try_port({"127.0.0.1", port}).error);
}

TEST(DoctorTest, Brokers) {
  const config::Endpoint broker{"broker.plant.example", 8883, true};
  EXPECT_EQ(find({judge(broker, {.reach = {.good = true}})}, "answers like a broker"), "ok");
  EXPECT_EQ(find({judge(broker, {.unknown_name = "Host not found"})}, "no address is known for broker.plant.example"),
            "error");
  EXPECT_EQ(find({judge(broker, {.addresses = {"192.0.2.1"}, .reach = {.why = "nobody answers"}})},
                 "not reached at 192.0.2.1: nobody answers"),
            "error");
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

}  // namespace
}  // namespace gateway::doctor
