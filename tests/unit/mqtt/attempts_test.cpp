#include "bridges/mqtt/attempts.h"

#include <gtest/gtest.h>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

TEST(Attempts, PausesDoubleUpToTheLongestWithBoundedJitter) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Attempts attempts(0, 1000ms, 30000ms, seed);
    auto whole = 1000ms;
    for (int i = 0; i < 100; ++i) {
      const auto pause = attempts.next_pause();
      EXPECT_LE(pause, whole);
      EXPECT_GE(pause, whole / 2);
      whole = std::min(whole * 2, std::chrono::milliseconds(30000));
    }
    attempts.held();
    EXPECT_LE(attempts.next_pause(), 1000ms);
  }
}

TEST(Attempts, PausesDifferFromGatewayToGateway) {
  Attempts one(0, 1000ms, 30000ms, 1);
  Attempts other(0, 1000ms, 30000ms, 2);
  int same = 0;
  for (int i = 0; i < 10; ++i) {
    same += one.next_pause() == other.next_pause() ? 1 : 0;
  }
  EXPECT_LT(same, 10);
}

TEST(Attempts, TakeOneAddressAfterTheOther) {
  Attempts attempts(0, 1000ms, 30000ms, 1);
  EXPECT_TRUE(attempts.wants_addresses());
  EXPECT_EQ(attempts.next_address(), "");
  attempts.found({"a", "b"});
  EXPECT_EQ(attempts.next_address(), "a");
  EXPECT_FALSE(attempts.wants_addresses());
  EXPECT_EQ(attempts.next_address(), "b");
  EXPECT_TRUE(attempts.wants_addresses());
  attempts.found({"a", "b"});
  EXPECT_EQ(attempts.next_address(), "a");
  EXPECT_EQ(attempts.next_version("a", 5, std::nullopt), std::nullopt);
  EXPECT_TRUE(attempts.wants_addresses()) << "the next connection asks anew";
}

TEST(Attempts, OlderMqttIsTriedWhereTheBrokerSaysSoOrClosesTwiceInARow) {
  const Refusal closed{.closed = true};
  Attempts attempts(0, 1000ms, 30000ms, 1);
  attempts.found({"a", "b"});
  EXPECT_EQ(attempts.first_version(), 5);
  EXPECT_EQ(attempts.next_version("a", 5, Refusal{.code = 1}), 4);
  EXPECT_EQ(attempts.next_version("a", 5, Refusal{.code = 0x84}), 4);
  EXPECT_EQ(attempts.next_version("a", 5, Refusal{.code = 0x87}), std::nullopt);
  EXPECT_EQ(attempts.next_version("a", 5, closed), std::nullopt);
  EXPECT_EQ(attempts.next_version("b", 5, closed), std::nullopt) << "each address counts by itself";
  EXPECT_EQ(attempts.next_version("a", 5, Refusal{}), std::nullopt);
  EXPECT_EQ(attempts.next_version("a", 5, closed), std::nullopt) << "in a row";
  EXPECT_EQ(attempts.next_version("a", 5, closed), 4);
  EXPECT_EQ(attempts.next_version("a", 4, std::nullopt), std::nullopt);
  EXPECT_EQ(attempts.next_version("b", 5, closed), 4);
  EXPECT_EQ(attempts.next_version("b", 4, closed), std::nullopt);
  EXPECT_EQ(attempts.next_version("b", 5, closed), std::nullopt) << "it closes whatever the version";
}

TEST(Attempts, AVersionThatIsConfiguredIsTheOnlyOne) {
  for (const int version : {4, 5}) {
    Attempts attempts(version, 1000ms, 30000ms, 1);
    attempts.found({"a"});
    EXPECT_EQ(attempts.first_version(), version);
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(attempts.next_version("a", version, Refusal{.closed = true}), std::nullopt);
    }
    EXPECT_EQ(attempts.next_version("a", version, Refusal{.code = 1}), std::nullopt);
  }
}

TEST(Attempts, AHostStandsInAUriAsItMust) {
  EXPECT_EQ(uri_host("192.0.2.1"), "192.0.2.1");
  EXPECT_EQ(uri_host("2001:db8::1"), "[2001:db8::1]");
}

}  // namespace
}  // namespace mqtt
