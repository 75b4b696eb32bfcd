#include "bridges/mqtt/attempts.h"

#include <gtest/gtest.h>

namespace mqtt {
namespace {

TEST(Attempts, TakeOneAddressAfterTheOther) {
  Attempts attempts(0);
  EXPECT_TRUE(attempts.wants_addresses());
  EXPECT_EQ(attempts.next_address(), "");
  attempts.found({"a", "b"});
  EXPECT_EQ(attempts.untried(), 2U);
  EXPECT_EQ(attempts.next_address(), "a");
  EXPECT_EQ(attempts.untried(), 1U);
  EXPECT_FALSE(attempts.wants_addresses());
  EXPECT_EQ(attempts.next_address(), "b");
  EXPECT_TRUE(attempts.wants_addresses());
  attempts.found({"a", "b"});
  EXPECT_EQ(attempts.next_address(), "a");
  EXPECT_EQ(attempts.addresses(), 2U);
  EXPECT_EQ(attempts.next_version("a", 5, std::nullopt), std::nullopt);
  EXPECT_FALSE(attempts.wants_addresses()) << "one behind which the broker fell silent is followed by the next";
  attempts.restart();
  EXPECT_EQ(attempts.untried(), 0U);
  EXPECT_TRUE(attempts.wants_addresses()) << "the next connection asks anew";
}

TEST(Attempts, OlderMqttIsTriedWhereTheBrokerSaysSoOrClosesTwiceInARow) {
  const Refusal closed{.closed = true};
  Attempts attempts(0);
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

TEST(Attempts, AnAddressThatClosedOnceIsToBeAskedOnceMore) {
  const Refusal closed{.closed = true};
  Attempts attempts(0);
  attempts.found({"a", "b"});
  EXPECT_FALSE(attempts.is_undecided("a"));
  (void)attempts.next_version("a", 5, closed);
  EXPECT_TRUE(attempts.is_undecided("a"));
  EXPECT_FALSE(attempts.is_undecided("b"));
  EXPECT_EQ(attempts.next_version("a", 5, closed), 4);
  EXPECT_FALSE(attempts.is_undecided("a")) << "3.1.1 was tried";
  Attempts only(5);
  only.found({"a"});
  (void)only.next_version("a", 5, closed);
  EXPECT_FALSE(only.is_undecided("a")) << "there is no other version";
}

TEST(Attempts, AVersionThatIsConfiguredIsTheOnlyOne) {
  for (const int version : {4, 5}) {
    Attempts attempts(version);
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
