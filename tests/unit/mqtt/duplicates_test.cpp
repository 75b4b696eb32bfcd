#include "bridges/mqtt/duplicates.h"

#include <gtest/gtest.h>

#include <string>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

const canopen::TimePoint kStart{1h};

Incoming command(std::string payload) {
  return {.topic = "B/pump1/set", .payload = std::move(payload)};
}

TEST(Duplicates, TheSameCommandWithAnIdIsOneFor60Seconds) {
  Duplicates duplicates;
  EXPECT_FALSE(duplicates.seen(command("a"), true, kStart));
  EXPECT_TRUE(duplicates.seen(command("a"), true, kStart + 59s));
  EXPECT_FALSE(duplicates.seen(command("a"), true, kStart + 60s));
}

TEST(Duplicates, SoIsOneWithCorrelationData) {
  Duplicates duplicates;
  Incoming first = command("a");
  first.correlation = "1";
  EXPECT_FALSE(duplicates.seen(first, false, kStart));
  EXPECT_TRUE(duplicates.seen(first, false, kStart));
  Incoming second = first;
  second.correlation = "2";
  EXPECT_FALSE(duplicates.seen(second, false, kStart));
}

TEST(Duplicates, StopStartStopIsCarriedOut) {
  Duplicates duplicates;
  EXPECT_FALSE(duplicates.seen(command("5"), false, kStart));
  EXPECT_FALSE(duplicates.seen(command("1"), false, kStart + 1s));
  EXPECT_FALSE(duplicates.seen(command("5"), false, kStart + 2s));
}

TEST(Duplicates, WhatTheBrokerDeliversAgainIsOneEvenWithoutAnId) {
  Duplicates duplicates;
  Incoming again = command("5");
  EXPECT_FALSE(duplicates.seen(again, false, kStart));
  again.redelivered = true;
  EXPECT_TRUE(duplicates.seen(again, false, kStart + 1s));
}

TEST(Duplicates, EveryPartCounts) {
  Duplicates duplicates;
  EXPECT_FALSE(duplicates.seen(command("a"), true, kStart));
  EXPECT_FALSE(duplicates.seen(command("b"), true, kStart));
  Incoming other = command("a");
  other.response_topic = "r";
  EXPECT_FALSE(duplicates.seen(other, true, kStart));
  other.topic = "B/fan/set";
  EXPECT_FALSE(duplicates.seen(other, true, kStart));
}

TEST(Duplicates, ForgetsTheOldestWhenItHoldsTooMuch) {
  Duplicates duplicates;
  EXPECT_FALSE(duplicates.seen(command("first"), true, kStart));
  for (int i = 0; i < 400; ++i) {
    EXPECT_FALSE(duplicates.seen(command(std::to_string(i) + std::string(16'000, 'x')), true, kStart));
  }
  EXPECT_FALSE(duplicates.seen(command("first"), true, kStart));
  EXPECT_TRUE(duplicates.seen(command("first"), true, kStart));
}

}  // namespace
}  // namespace mqtt
