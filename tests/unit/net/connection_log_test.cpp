#include "bridges/net/connection_log.h"

#include <gmock/gmock.h>

#include <chrono>
#include <string>
#include <vector>

#include "tests/support/hand_driven_loop.h"

namespace {

using net::ConnectionLog;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

class ConnectionLogTest : public testing::Test {
 protected:
  void advance_swept(int count) {
    for (int i = 0; i < count; ++i) {
      loop_.advance(seconds(1), seconds(1));
      log_.sweep();
    }
  }
  std::vector<std::string> infos() { return std::exchange(infos_, {}); }
  std::vector<std::string> warnings() { return std::exchange(warnings_, {}); }

  support::HandDrivenLoop loop_;
  std::vector<std::string> infos_;
  std::vector<std::string> warnings_;
  ConnectionLog log_{"Modbus",
                     {.info = [this](const std::string& text) { infos_.push_back(text); },
                      .warning = [this](const std::string& text) { warnings_.push_back(text); }}};
};

TEST_F(ConnectionLogTest, TellsOnceAMinuteAndHowOftenItCameAgain) {
  for (int i = 0; i < 100; ++i) {
    log_.warn("192.0.2.7", "refused");
  }
  EXPECT_THAT(warnings(), ElementsAre("Modbus: 192.0.2.7: refused"));
  advance_swept(59);
  log_.warn("192.0.2.7", "refused");
  EXPECT_THAT(warnings(), IsEmpty());
  advance_swept(1);
  EXPECT_THAT(warnings(), ElementsAre("Modbus: 192.0.2.7: refused (100 times more in the last minute)"));
  advance_swept(60);
  EXPECT_THAT(warnings(), IsEmpty());
  log_.warn("192.0.2.7", "refused");
  EXPECT_THAT(warnings(), ElementsAre("Modbus: 192.0.2.7: refused"));
  EXPECT_THAT(infos(), IsEmpty());
}

TEST_F(ConnectionLogTest, TellsEachAddressAndEachThing) {
  log_.info("192.0.2.7", "connected");
  log_.info("192.0.2.7", "has left");
  log_.info("192.0.2.8", "connected");
  EXPECT_THAT(infos(), ElementsAre("Modbus: 192.0.2.7: connected", "Modbus: 192.0.2.7: has left",
                                   "Modbus: 192.0.2.8: connected"));
  EXPECT_THAT(warnings(), IsEmpty());
}

TEST_F(ConnectionLogTest, OfCountlessAddressesTellsOnlyThatTheyCame) {
  for (int i = 0; i < 10'000; ++i) {
    log_.warn(std::to_string(i), "refused");
  }
  const std::vector<std::string> told = warnings();
  ASSERT_EQ(told.size(), 257U);
  EXPECT_EQ(told.back(), "Modbus: further addresses: more than the log tells of in a minute");
  log_.warn("0", "refused");
  EXPECT_THAT(warnings(), IsEmpty());
  advance_swept(60);
  EXPECT_THAT(warnings(),
              ElementsAre("Modbus: 0: refused (1 times more in the last minute)",
                          "Modbus: further addresses: more than the log tells of in a minute (9743 times more in the "
                          "last minute)"));
  advance_swept(61);
  log_.warn("fresh", "refused");
  EXPECT_THAT(warnings(), ElementsAre("Modbus: fresh: refused")) << "a minute later there is room again";
}

TEST_F(ConnectionLogTest, WhatTheServerSaysOfItselfIsToldBesideAnyNumberOfStrangers) {
  for (int i = 0; i < 1000; ++i) {
    log_.warn("192.0.2." + std::to_string(i), "refused");
  }
  (void)warnings();
  log_.own_warn("0.0.0.0:502", "cannot take a connection");
  log_.own_info("0.0.0.0:502", "listening");
  log_.own_warn("0.0.0.0:502", "cannot take a connection");
  EXPECT_THAT(warnings(), ElementsAre("Modbus: 0.0.0.0:502: cannot take a connection"));
  EXPECT_THAT(infos(), ElementsAre("Modbus: 0.0.0.0:502: listening"));
  advance_swept(121);
  (void)warnings();
  for (int i = 0; i < 256; ++i) {
    log_.own_warn("0.0.0.0:" + std::to_string(i), "cannot take a connection");
  }
  EXPECT_EQ(warnings().size(), 256U);
  log_.warn("192.0.2.7", "refused");
  EXPECT_THAT(warnings(), ElementsAre("Modbus: 192.0.2.7: refused")) << "nor do they take the room of strangers";
}

TEST_F(ConnectionLogTest, WithNobodyToTellNothingIsKept) {
  ConnectionLog mute("Modbus", {});
  mute.warn("192.0.2.7", "refused");
  mute.sweep();
  EXPECT_THAT(warnings(), IsEmpty());
}

}  // namespace
