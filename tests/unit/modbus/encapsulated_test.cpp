#include <gtest/gtest.h>

#include <chrono>
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

/// The drive's own part of its identity.
class ToldIdentity : public testing::Test {
 protected:
  void have_all() {
    auto& dictionary = site_.puppet().dictionary;
    dictionary[{0x1018, 4}] = {.value = 4'000'000'001, .size = 4};
    dictionary[{0x1009, 0}] = {.value = 0x20612E31, .size = 4};  // "1.a "
    dictionary[{0x100A, 0}] = {.value = 0x00000732, .size = 4};  // "2", no letter, and what pads it
  }
  /// What follows the head; an exception as a whole.
  std::string ask(const std::string& pdu) {
    TcpClient& client = site_.client();
    const Bytes request = frame(kUnit, pdu);
    EXPECT_EQ(client.send(request), request.size());
    const auto answered = [&client] {
      client.receive();
      return client.has_frame();
    };
    site_.settle();
    // What is read by SDO waits a little for its share of the bus.
    EXPECT_TRUE(site_.loop().advance_until(answered, std::chrono::milliseconds(100)));
    const Bytes answer = client.take_frame();
    return {answer.begin() + (answer[7] == 0x2B ? 14 : 7), answer.end()};
  }
  const std::string kKnown = std::string("\x80\x05pump1\x81\x00", 9);

  Site site_;
};

TEST_F(ToldIdentity, IsReadFromTheDriveWhenItIsAskedFor) {
  site_.bring_up();
  have_all();
  EXPECT_EQ(ask("2b 0e 03 80"), kKnown +
                                    "\x82\x0a"
                                    "4000000001"
                                    "\x83\x03"
                                    "1.a"
                                    "\x84\x02"
                                    "2?");
  site_.puppet().dictionary[{0x1018, 4}].value = 7;
  EXPECT_EQ(ask("2b 0e 04 82"),
            "\x82\x01"
            "7");
  EXPECT_EQ(ask("2b 0e 03 84"),
            "\x84\x02"
            "2?");
}

TEST_F(ToldIdentity, WhatTheDriveLacksIsLeftOut) {
  site_.bring_up();
  EXPECT_EQ(ask("2b 0e 03 80"), kKnown);
  have_all();
  site_.puppet().dictionary.erase({0x1009, 0});
  EXPECT_EQ(ask("2b 0e 03 80"), kKnown +
                                    "\x82\x0a"
                                    "4000000001"
                                    "\x84\x02"
                                    "2?");
  EXPECT_EQ(ask("2b 0e 04 83"), "\xab\x02");
}

TEST_F(ToldIdentity, ADriveThatIsNotThereTellsNothing) {
  have_all();
  EXPECT_EQ(ask("2b 0e 03 80"), kKnown);
  EXPECT_EQ(ask("2b 0e 04 82"), "\xab\x0b");
  EXPECT_EQ(ask("2b 0e 01 00").substr(0, 2), std::string("\x00\x0f", 2));
}

TEST_F(ToldIdentity, ADriveThatDoesNotAnswerIsAskedForOneObject) {
  site_.bring_up();
  have_all();
  site_.puppet().mute = true;
  TcpClient& client = site_.client();
  const Bytes request = frame(kUnit, "2b 0e 03 80");
  EXPECT_EQ(client.send(request), request.size());
  const auto answered = [&client] {
    client.receive();
    return client.has_frame();
  };
  const canopen::TimePoint before = canopen::Clock::now();
  site_.settle();
  EXPECT_TRUE(site_.loop().advance_until(answered, std::chrono::seconds(5)));
  EXPECT_LE(canopen::Clock::now() - before, std::chrono::milliseconds(1600)) << "three tries of half a second";
  const Bytes answer = client.take_frame();
  EXPECT_EQ(std::string(answer.begin() + 14, answer.end()), kKnown);
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
