#include <gtest/gtest.h>

#include <string>

#include "tests/unit/modbus/site.h"

// Function 43, and what libmodbus has no words for.

namespace {

using modbus_test::Bytes;
using modbus_test::frame;
using modbus_test::kUnit;
using modbus_test::Site;
using modbus_test::TcpClient;

TEST(Encapsulated, FunctionsThatNoRequestHasAreRefusedAsTheyAre) {
  Site site;
  EXPECT_EQ(site.ask("80"), "80 01");
  EXPECT_EQ(site.ask("90 0064 0001 02 0005"), "90 01");
  EXPECT_EQ(site.ask("ff"), "ff 01");
  EXPECT_EQ(site.ask("ab 0e 01 00"), "ab 01");
  EXPECT_EQ(site.ask("07"), "87 01");
  EXPECT_EQ(site.ask(site.client(), 77, "90"), "90 0a");
  EXPECT_EQ(site.ask("03 0064 0001"), "03 02 0000");
}

TEST(Encapsulated, UnknownKindsAreRefused) {
  Site site;
  EXPECT_EQ(site.ask("2b 0f 00"), "ab 01");
  EXPECT_EQ(site.ask("2b"), "ab 03");
  EXPECT_EQ(site.ask(site.client(), 77, "2b 0e 01 00"), "ab 0a");
}

// The bytes behind the header.
std::string text_in(Site& site, std::uint8_t unit, const std::string& pdu) {
  TcpClient& client = site.client();
  const Bytes request = frame(unit, pdu);
  EXPECT_EQ(client.send(request), request.size());
  EXPECT_TRUE(site.settle_until([&client] {
    client.receive();
    return client.has_frame();
  }));
  const Bytes answer = client.take_frame();
  return {answer.begin() + 7, answer.end()};
}

TEST(Encapsulated, EveryUnitSaysWhoItIs) {
  Site site;
  EXPECT_EQ(text_in(site, kUnit, "2b 0e 04 80").substr(7), "\x80\x05pump1");
  for (const std::uint8_t unit : {std::uint8_t{0}, std::uint8_t{255}}) {
    EXPECT_EQ(text_in(site, unit, "2b 0e 04 00").substr(7), std::string("\0\x0f"
                                                                        "canopen-gateway",
                                                                        17));
    EXPECT_NE(text_in(site, unit, "2b 0e 04 06"), text_in(site, kUnit, "2b 0e 04 06"));
  }
}

TEST(Encapsulated, StaysInOrderWithOthers) {
  Site site;
  TcpClient& client = site.client();
  Bytes bytes = frame(kUnit, "2b 0e 04 80", 1);
  for (const Bytes& more : {frame(kUnit, "03 0064 0001", 2), frame(kUnit, "90", 3), frame(kUnit, "2b 0e 04 80", 4)}) {
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  EXPECT_EQ(client.send(bytes), bytes.size());
  for (const int transaction : {1, 2, 3, 4}) {
    ASSERT_TRUE(site.settle_until([&client] {
      client.receive();
      return client.has_frame();
    }));
    EXPECT_EQ(client.take_frame()[1], transaction);
  }
}

}  // namespace
