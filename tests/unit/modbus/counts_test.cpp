// What is counted of requests.

#include <gtest/gtest.h>

#include "tests/unit/modbus/site.h"

namespace {

using modbus::Exception;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;

std::uint64_t count_of(Site& site, Exception exception) {
  return site.server().counts().exceptions.at(static_cast<std::size_t>(exception));
}

TEST(ModbusCounts, AreOfAllClients) {
  Site site;
  site.bring_up();
  EXPECT_EQ(site.ask("03 03E9 0001"), "03 02 0005");
  EXPECT_EQ(site.server().counts().requests, 1U);
  TcpClient other(site.port());
  EXPECT_EQ(site.ask(other, kUnit, "03 7000 0001"), "83 02");
  EXPECT_EQ(site.ask(other, 77, "03 0000 0001"), "83 0a");
  EXPECT_EQ(site.ask(other, kUnit, "63"), "e3 01");
  EXPECT_EQ(site.ask(other, kUnit, "90"), "90 01") << "a function that is an exception itself";
  EXPECT_EQ(site.server().counts().requests, 5U);
  EXPECT_EQ(count_of(site, Exception::illegal_address), 1U);
  EXPECT_EQ(count_of(site, Exception::unknown_unit), 1U);
  EXPECT_EQ(count_of(site, Exception::illegal_function), 2U);
  EXPECT_EQ(count_of(site, Exception::no_response), 0U);
}

}  // namespace
