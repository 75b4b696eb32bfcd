#include <gtest/gtest.h>

#include <cstdint>

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
  EXPECT_TRUE(site.settle_until([&site] { return site.port() != 0; }));
}

}  // namespace
