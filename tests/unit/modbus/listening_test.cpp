#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/unit/modbus/site.h"

namespace {

using modbus_test::example_model;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;

TEST(Listening, Ipv6AndBothAtOnce) {
  config::Model model = example_model();
  model.modbus->listen = {{"::1", 0}, {"127.0.0.1", 0}};
  Site site(model);
  TcpClient v6(site.server().port(0), "::1");
  ASSERT_TRUE(v6.connected()) << "this machine needs IPv6 on its loopback interface";
  EXPECT_EQ(site.ask(v6, kUnit, "03 0064 0001"), "03 02 0000");
  EXPECT_EQ(site.ask(v6, kUnit, "06 012c 0001"), "86 0b");  // ::1 may write; the drive is not there
  TcpClient v4(site.server().port(1));
  EXPECT_EQ(site.ask(v4, kUnit, "03 0064 0001"), "03 02 0000");
}

TEST(Listening, AnyAddressOfBothKindsOnOnePort) {
  config::Model model = example_model();
  std::uint16_t free_port = 0;
  {
    Site site(model);
    free_port = site.port();
  }
  model.modbus->listen = {{"0.0.0.0", free_port}, {"::", free_port}};
  Site site(model);
  TcpClient v4(free_port);
  EXPECT_EQ(site.ask(v4, kUnit, "03 0064 0001"), "03 02 0000");
  TcpClient v6(free_port, "::1");
  EXPECT_EQ(site.ask(v6, kUnit, "03 0064 0001"), "03 02 0000");
}

TEST(Listening, ANameIsResolved) {
  config::Model model = example_model();
  model.modbus->listen = {{"localhost", 0}};
  Site site(model);
  EXPECT_NE(site.port(), 0);
}

std::string start_failure(Site& site, const config::Endpoint& endpoint) {
  config::Modbus settings;
  settings.listen = {endpoint};
  modbus::Server server(site.loop().executor(), site.plant(), settings);
  try {
    server.start();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "started";
}

TEST(Listening, AFailureNamesPlaceCauseAndRemedy) {
  Site site;
  const std::string taken = start_failure(site, {"127.0.0.1", site.port()});
  EXPECT_NE(taken.find("[modbus] listen: cannot listen on 127.0.0.1:" + std::to_string(site.port())), std::string::npos)
      << taken;
  EXPECT_NE(taken.find("in use"), std::string::npos) << taken;
  EXPECT_NE(taken.find("another port"), std::string::npos) << taken;
  const std::string foreign = start_failure(site, {"192.0.2.1", 0});
  EXPECT_NE(foreign.find("192.0.2.1:0"), std::string::npos) << foreign;
  EXPECT_NE(foreign.find("this machine must have the address"), std::string::npos) << foreign;
  const std::string foreign_v6 = start_failure(site, {"2001:db8::1", 1502});
  EXPECT_NE(foreign_v6.find("[2001:db8::1]:1502"), std::string::npos) << foreign_v6;
  EXPECT_NE(start_failure(site, {"no-such-host.invalid", 1502}).find("no-such-host.invalid:1502"), std::string::npos);
}

}  // namespace
