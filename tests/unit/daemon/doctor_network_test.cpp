// What doctor says of the gateway itself, of ports and of brokers.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <csignal>
#include <filesystem>
#include <string>

#include "daemon/doctor/network.h"
#include "daemon/doctor/port_owner.h"
#include "daemon/doctor/presence.h"
#include "tests/unit/daemon/doctor_lines.h"

namespace gateway::doctor {
namespace {

using namespace std::chrono_literals;

TEST(DoctorNetworkTest, WhetherTheGatewayRuns) {
  const auto state = [](const char* socket, const GatewayFacts& facts) {
    EXPECT_EQ(judge(socket, facts).remedy.empty(), judge(socket, facts).verdict == Verdict::ok);
    EXPECT_NE(judge(socket, facts).verdict, Verdict::error);
    return presence_of(socket, facts);
  };
  EXPECT_EQ(state("/run/control", {}), Presence::runs);
  EXPECT_EQ(state("", {}), Presence::unknown);
  EXPECT_EQ(state("/run/control", {.error = error_of(std::errc::no_such_file_or_directory)}), Presence::absent);
  EXPECT_EQ(state("/run/control", {.error = error_of(std::errc::connection_refused)}), Presence::absent);
  EXPECT_EQ(state("/run/control", {.error = error_of(std::errc::permission_denied)}), Presence::unknown);
  EXPECT_EQ(state("/run/control", {.error = error_of(std::errc::resource_unavailable_try_again)}), Presence::unknown);
  EXPECT_EQ(state("/run/control", {.silence = "the gateway has not answered within 3 s"}), Presence::unknown);
}

TEST(DoctorNetworkTest, AGatewayThatHangsIsNotOneThatDoesNotRun) {
  const std::string path = testing::TempDir() + "doctor-" + std::to_string(::getpid());
  EXPECT_EQ(presence_of(path, ask_gateway(path, 1ms)), Presence::absent) << "no such socket";
  {
    boost::asio::io_context io;
    const boost::asio::local::stream_protocol::acceptor mute(io, path);
    const GatewayFacts facts = ask_gateway(path, 1ms);
    EXPECT_EQ(presence_of(path, facts), Presence::unknown);
    EXPECT_EQ(facts.process, ::getpid());
  }
  EXPECT_EQ(presence_of(path, ask_gateway(path, 1ms)), Presence::absent) << "nobody behind it";
  std::filesystem::remove(path);
  EXPECT_EQ(presence_of({}, ask_gateway({}, 1ms)), Presence::unknown) << "nothing to ask at";
}

TEST(DoctorNetworkTest, Ports) {
  const config::Endpoint port{"0.0.0.0", 502};
  const PortHolder root{.gateway = Presence::absent, .privileged = true};
  const PortHolder running{.gateway = Presence::runs, .privileged = true};
  const PortHolder unknown{.gateway = Presence::unknown, .privileged = true};
  EXPECT_EQ(find({judge(port, {}, root)}, "free"), "ok");
  EXPECT_EQ(find({judge(port, {}, running)}, "does not listen there"), "warning");
  const PortFacts taken{.error = error_of(std::errc::address_in_use)};
  EXPECT_EQ(find({judge(port, taken, root)}, "another program"), "error");
  EXPECT_EQ(find({judge(port, taken, running)}, "in use, and the gateway runs; whether it is the one"), "ok");
  EXPECT_EQ(find({judge(port, taken, unknown)}, "in use, by the gateway or by another program"), "warning");
  EXPECT_EQ(find({judge(port, {}, unknown)}, "free"), "ok");
  const PortFacts own{.error = error_of(std::errc::address_in_use), .of_gateway = true};
  const PortFacts others{.error = error_of(std::errc::address_in_use), .of_gateway = false};
  for (const PortHolder& holder : {running, unknown}) {
    EXPECT_EQ(find({judge(port, own, holder)}, "the gateway listens there"), "ok");
    EXPECT_EQ(find({judge(port, others, holder)}, "another program listens there"), "error");
  }
  const PortFacts away{.error = error_of(std::errc::address_not_available)};
  EXPECT_EQ(find({judge(port, away, root)}, "does not have that address"), "warning");
  const PortFacts forbidden{.error = error_of(std::errc::permission_denied)};
  EXPECT_EQ(find({judge(port, forbidden, {})}, "only root may try"), "warning");
  EXPECT_EQ(find({judge(port, forbidden, root)}, "Permission denied"), "error");
  EXPECT_EQ(find({judge(port, {.unknown_name = "Host not found"}, root)}, "no address is known for 0.0.0.0"),
            "warning");
}

TEST(DoctorNetworkTest, APortOfRootIsOnlyGoodWhereSomethingOpensItForTheService) {
  const config::Endpoint port{"127.0.0.1", 502};
  const PortFacts of_root{.needs_privilege = true};
  const auto judged = [&](const ServiceFacts& service, Presence gateway, bool may_be_passed = true) {
    return judge(port, of_root,
                 {.gateway = gateway,
                  .privileged = true,
                  .opener = opener_of(port, service, may_be_passed),
                  .may_be_passed = may_be_passed});
  };
  const ServiceFacts other{.installed = true, .sockets = {"0.0.0.0:502"}};
  const ServiceFacts same{.installed = true, .sockets = {"0.0.0.0:502", "127.0.0.1:502"}};
  const ServiceFacts privileged{.installed = true, .takes_any_port = true};
  for (const Presence gateway : {Presence::absent, Presence::runs, Presence::unknown}) {
    EXPECT_EQ(find({judged({}, gateway)}, "free, but canopen-gateway may not take it"), "warning");
    EXPECT_EQ(find({judged(other, gateway)}, "free, but canopen-gateway may not take it"), "warning");
    EXPECT_NE(judged(other, gateway).remedy.find("ListenStream=127.0.0.1:502"), std::string::npos);
    EXPECT_EQ(find({judged(same, gateway, false)}, "free, but canopen-gateway may not take it"), "warning")
        << "HTTP takes no socket of systemd";
  }
  EXPECT_EQ(find({judged(same, Presence::absent)}, "free; opened by canopen-gateway.socket"), "ok");
  EXPECT_EQ(find({judged(privileged, Presence::absent, false)}, "free; opened by the service"), "ok");
  EXPECT_EQ(find({judged(same, Presence::runs)}, "does not listen there"), "warning");
}

TEST(DoctorNetworkTest, APortThatIsTakenIsSeen) {
  boost::asio::io_context io;
  boost::asio::ip::tcp::acceptor taken(io, {boost::asio::ip::address_v4::loopback(), 0});
  const std::uint16_t port = taken.local_endpoint().port();
  EXPECT_EQ(try_port({"127.0.0.1", port}, 0).error, std::errc::address_in_use);
  EXPECT_EQ(try_port({"127.0.0.1", port}, 0).of_gateway, std::nullopt);
  EXPECT_EQ(try_port({"127.0.0.1", port}, ::getpid()).of_gateway, true);
  taken.close();
  EXPECT_FALSE(try_port({"127.0.0.1", port}, ::getpid()).error);
}

// A child that has nothing open; ended with this object.
struct Stranger {
  Stranger() {
    if (process == 0) {
      ::close_range(0, ~0U, 0);
      ::raise(SIGSTOP);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(process, &status, WUNTRACED);
  }
  ~Stranger() {
    ::kill(process, SIGKILL);
    ::waitpid(process, nullptr, 0);
  }
  Stranger(const Stranger&) = delete;
  Stranger& operator=(const Stranger&) = delete;
  pid_t process = ::fork();
};

TEST(DoctorNetworkTest, WhoseAPortIsTheProcessTells) {
  using boost::asio::ip::make_address;
  using boost::asio::ip::tcp;
  boost::asio::io_context io;
  const Stranger stranger;
  for (const char* const address : {"127.0.0.1", "0.0.0.0", "::1", "::"}) {
    const tcp::acceptor taken(io, {make_address(address), 0});
    const std::uint16_t port = taken.local_endpoint().port();
    EXPECT_EQ(is_held_by({make_address(address), port}, ::getpid()), true) << address;
    EXPECT_EQ(is_held_by({make_address(address), port}, stranger.process), false) << address;
    EXPECT_EQ(is_held_by({make_address(address), port}, 0), std::nullopt) << address;
  }
  const tcp::acceptor both(io, {make_address("::"), 0});  // of IPv4 too
  EXPECT_EQ(is_held_by({make_address("127.0.0.1"), both.local_endpoint().port()}, ::getpid()), true);
  const tcp::acceptor one(io, {make_address("127.0.0.1"), 0});
  EXPECT_EQ(is_held_by({make_address("127.0.0.2"), one.local_endpoint().port()}, ::getpid()), std::nullopt);
  EXPECT_EQ(is_held_by({make_address("0.0.0.0"), one.local_endpoint().port()}, stranger.process), false);
}

TEST(DoctorNetworkTest, Brokers) {
  const config::Endpoint broker{"broker.plant.example", 8883, true};
  EXPECT_EQ(find({judge(broker, {.reach = {.good = true, .manner = mqtt::Manner::connack}})}, "answers like a broker"),
            "ok");
  EXPECT_EQ(find({judge(broker, {.unknown_name = "Host not found"})}, "no address is known for broker.plant.example"),
            "error");
  EXPECT_EQ(find({judge(broker, {.addresses = {"192.0.2.1"}, .reach = {.why = "nobody answers"}})},
                 "not reached at 192.0.2.1: nobody answers"),
            "error");
  for (const mqtt::Manner manner : {mqtt::Manner::closes, mqtt::Manner::foreign}) {
    EXPECT_EQ(find({judge({"192.0.2.1", 8883}, {.reach = {.manner = manner}, .speaks_tls = true})}, "speaks TLS"),
              "error");
  }
  for (const bool tls : {false, true}) {
    const config::Endpoint at{"192.0.2.1", 1883, tls};
    EXPECT_EQ(find({judge(at, {.reach = {.good = true, .manner = mqtt::Manner::closes}})}, "may be a broker or not"),
              "warning");
    EXPECT_EQ(
        find({judge(at, {.reach = {.why = "no MQTT broker", .manner = mqtt::Manner::foreign}})}, "no MQTT broker"),
        "error");
  }
}

TEST(DoctorNetworkTest, NoTlsIsTriedWithoutItsFiles) {
  config::Mqtt mqtt;
  const config::Endpoint tls{"127.0.0.1", 1, true};
  EXPECT_EQ(find({judge(tls, try_broker(mqtt, tls, true, 1ms))}, "not tried: a file for TLS is not there"), "warning");
  EXPECT_EQ(find({judge(tls, try_broker(mqtt, tls, false, 1ms))}, "not reached"), "error");
  const config::Endpoint plain{"127.0.0.1", 1};
  EXPECT_EQ(find({judge(plain, try_broker(mqtt, plain, true, 1ms))}, "not reached"), "error") << "it needs none";
}

}  // namespace
}  // namespace gateway::doctor
