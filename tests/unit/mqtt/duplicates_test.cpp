#include "bridges/mqtt/duplicates.h"

#include <gtest/gtest.h>

#include <string>

namespace mqtt {
namespace {

using namespace std::chrono_literals;
using canopen::Error;
using canopen::ErrorKind;

const canopen::TimePoint kStart{1h};

Incoming command(std::string payload) {
  return {.topic = "B/pump1/set", .payload = std::move(payload)};
}

/// A repetition; else it is remembered.
bool seen(Duplicates& duplicates, const Incoming& incoming, bool has_id, canopen::TimePoint now) {
  if (duplicates.earlier(incoming, has_id, now)) {
    return true;
  }
  EXPECT_NE(duplicates.remember(incoming, now), Duplicates::kNone);
  return false;
}

process::Outcome failed(ErrorKind kind) {
  return Error{.kind = kind};
}

TEST(Duplicates, TheSameCommandWithAnIdIsOneFor60Seconds) {
  Duplicates duplicates;
  EXPECT_FALSE(seen(duplicates, command("a"), true, kStart));
  EXPECT_TRUE(seen(duplicates, command("a"), true, kStart + 59s));
  EXPECT_FALSE(seen(duplicates, command("a"), true, kStart + 60s));
}

TEST(Duplicates, SoIsOneWithCorrelationData) {
  Duplicates duplicates;
  Incoming first = command("a");
  first.correlation = "1";
  EXPECT_FALSE(seen(duplicates, first, false, kStart));
  EXPECT_TRUE(seen(duplicates, first, false, kStart));
  Incoming second = first;
  second.correlation = "2";
  EXPECT_FALSE(seen(duplicates, second, false, kStart));
}

TEST(Duplicates, StopStartStopIsCarriedOut) {
  Duplicates duplicates;
  EXPECT_FALSE(seen(duplicates, command("5"), false, kStart));
  EXPECT_FALSE(seen(duplicates, command("1"), false, kStart + 1s));
  EXPECT_FALSE(seen(duplicates, command("5"), false, kStart + 2s));
}

TEST(Duplicates, WhatTheBrokerDeliversAgainIsOneEvenWithoutAnId) {
  Duplicates duplicates;
  Incoming again = command("5");
  EXPECT_FALSE(seen(duplicates, again, false, kStart));
  again.redelivered = true;
  EXPECT_TRUE(seen(duplicates, again, false, kStart + 1s));
}

TEST(Duplicates, EveryPartCounts) {
  Duplicates duplicates;
  EXPECT_FALSE(seen(duplicates, command("a"), true, kStart));
  EXPECT_FALSE(seen(duplicates, command("b"), true, kStart));
  Incoming other = command("a");
  other.response_topic = "r";
  EXPECT_FALSE(seen(duplicates, other, true, kStart));
  other.topic = "B/fan/set";
  EXPECT_FALSE(seen(duplicates, other, true, kStart));
}

TEST(Duplicates, ForgetsTheOldestWhenItHoldsTooMuch) {
  Duplicates duplicates;
  EXPECT_FALSE(seen(duplicates, command("first"), true, kStart));
  for (int i = 0; i < 400; ++i) {
    EXPECT_FALSE(seen(duplicates, command(std::to_string(i) + std::string(16'000, 'x')), true, kStart));
  }
  EXPECT_FALSE(seen(duplicates, command("first"), true, kStart));
  EXPECT_TRUE(seen(duplicates, command("first"), true, kStart));
}

TEST(Duplicates, TellsWhatBecameOfTheFirstOnceThatIsKnown) {
  Duplicates duplicates;
  const Duplicates::Ticket ticket = duplicates.remember(command("a"), kStart);
  auto earlier = duplicates.earlier(command("a"), true, kStart + 1s);
  ASSERT_TRUE(earlier);
  EXPECT_EQ(earlier->ticket, ticket);
  EXPECT_EQ(earlier->first, std::nullopt);
  duplicates.settle(ticket, R"({"ok":true})");
  earlier = duplicates.earlier(command("a"), true, kStart + 2s);
  ASSERT_TRUE(earlier);
  EXPECT_EQ(earlier->first, R"({"ok":true})");
}

TEST(Duplicates, WhatIsForgottenIsANewCommand) {
  Duplicates duplicates;
  const Duplicates::Ticket first = duplicates.remember(command("a"), kStart);
  const Duplicates::Ticket other = duplicates.remember(command("b"), kStart);
  duplicates.forget(first);
  EXPECT_FALSE(duplicates.earlier(command("a"), true, kStart));
  EXPECT_TRUE(duplicates.earlier(command("b"), true, kStart));
  const Duplicates::Ticket again = duplicates.remember(command("a"), kStart + 1s);
  duplicates.settle(first, "old");
  duplicates.forget(first);
  const auto earlier = duplicates.earlier(command("a"), true, kStart + 1s);
  ASSERT_TRUE(earlier);
  EXPECT_EQ(earlier->ticket, again);
  EXPECT_EQ(earlier->first, std::nullopt) << "what became of the one that is forgotten is not its outcome";
  duplicates.forget(other);
  duplicates.forget(again);
  EXPECT_FALSE(duplicates.earlier(command("a"), true, kStart + 1s));
}

TEST(Duplicates, OfCommandsWithoutAnIdTheNewestIsRemembered) {
  Duplicates duplicates;
  const Duplicates::Ticket first = duplicates.remember(command("30"), kStart);
  duplicates.settle(first, "first");
  const Duplicates::Ticket second = duplicates.remember(command("30"), kStart + 30s);
  Incoming again = command("30");
  again.redelivered = true;
  auto earlier = duplicates.earlier(again, false, kStart + 70s);
  ASSERT_TRUE(earlier);
  EXPECT_EQ(earlier->ticket, second);
  EXPECT_EQ(earlier->first, std::nullopt);
  EXPECT_FALSE(duplicates.earlier(again, false, kStart + 90s));
}

TEST(Duplicates, OutcomesCountForWhatItHolds) {
  Duplicates duplicates;
  const Duplicates::Ticket old = duplicates.remember(command("old"), kStart);
  const Duplicates::Ticket big = duplicates.remember(command("big"), kStart);
  duplicates.settle(old, std::string(Duplicates::kCapacity / 2, 'x'));
  EXPECT_TRUE(duplicates.earlier(command("old"), true, kStart));
  duplicates.settle(big, std::string(Duplicates::kCapacity / 2, 'x'));
  EXPECT_FALSE(duplicates.earlier(command("old"), true, kStart));
  EXPECT_TRUE(duplicates.earlier(command("big"), true, kStart));
}

TEST(Duplicates, OnlyWhatWasRefusedBeforeAnythingWasSentMayComeAgain) {
  for (const ErrorKind kind : {ErrorKind::forbidden, ErrorKind::offline, ErrorKind::lease, ErrorKind::range,
                               ErrorKind::type, ErrorKind::incomplete}) {
    EXPECT_TRUE(may_come_again(failed(kind))) << name_of(kind);
    process::Outcome written = failed(kind);
    written.written = 1;
    EXPECT_FALSE(may_come_again(written)) << name_of(kind);
    EXPECT_FALSE(may_come_again(Error{.kind = kind, .abort = 0x06010002})) << name_of(kind);
    EXPECT_FALSE(may_come_again(Error{.kind = kind, .outcome_unknown = true})) << name_of(kind);
  }
  for (const ErrorKind kind : {ErrorKind::superseded, ErrorKind::voided, ErrorKind::expired, ErrorKind::refused,
                               ErrorKind::timeout, ErrorKind::unknown, ErrorKind::read_only, ErrorKind::protocol}) {
    EXPECT_FALSE(may_come_again(failed(kind))) << name_of(kind);
  }
  EXPECT_FALSE(may_come_again({})) << "it was carried out";
}

}  // namespace
}  // namespace mqtt
