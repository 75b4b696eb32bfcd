#include "canopen/survey/suspicion_hold.h"

#include <gtest/gtest.h>

namespace canopen {
namespace {

using namespace std::chrono_literals;

class SuspicionHoldTest : public testing::Test {
 protected:
  /// A look each second.
  SuspicionHold::Change look(std::optional<SuspicionKind> kind) {
    now_ += 1s;
    const auto judged = kind ? std::optional(Suspicion{.kind = *kind, .seen = {}, .look = {}}) : std::nullopt;
    SuspicionHold::Change change = hold_.look(judged, now_, WallTime(now_.time_since_epoch()));
    began_ += change.began ? 1 : 0;
    displaced_ += change.displaced ? 1 : 0;
    ended_ += change.ended ? 1 : 0;
    return change;
  }
  void look(std::optional<SuspicionKind> kind, int times) {
    for (int i = 0; i < times; ++i) {
      look(kind);
    }
  }
  [[nodiscard]] std::optional<SuspicionKind> standing() const {
    return hold_.standing() ? std::optional(hold_.standing()->kind) : std::nullopt;
  }

  SuspicionHold hold_;
  TimePoint now_{1h};
  int began_ = 0;
  int displaced_ = 0;
  int ended_ = 0;
};

TEST_F(SuspicionHoldTest, BeginsWithTheThirdLookInARow) {
  look(SuspicionKind::alone, 2);
  look(std::nullopt);
  look(SuspicionKind::alone, 2);
  look(SuspicionKind::bit_rate);
  look(SuspicionKind::alone, 2);
  EXPECT_FALSE(standing());
  EXPECT_EQ(look(SuspicionKind::alone).began->kind, SuspicionKind::alone);
  EXPECT_EQ(standing(), SuspicionKind::alone);
  EXPECT_EQ(hold_.since(), WallTime(now_.time_since_epoch()));
}

TEST_F(SuspicionHoldTest, EndsAMinuteAfterItsNewestSignAndOnce) {
  look(SuspicionKind::overload, 3);
  look(std::nullopt, 59);
  EXPECT_TRUE(standing());
  EXPECT_EQ(look(std::nullopt).ended->kind, SuspicionKind::overload);
  EXPECT_FALSE(standing());
  look(std::nullopt, 100);
  EXPECT_EQ(ended_, 1);
}

TEST_F(SuspicionHoldTest, WhatComesAndGoesIsToldOnce) {
  look(SuspicionKind::wiring, 3);
  for (int i = 0; i < 20; ++i) {
    look(std::nullopt, 300);
    look(SuspicionKind::wiring);
  }
  EXPECT_EQ(began_, 1);
  EXPECT_EQ(ended_, 0);
  look(std::nullopt, 599);
  EXPECT_EQ(ended_, 0);
  look(std::nullopt);
  EXPECT_EQ(ended_, 1);
}

TEST_F(SuspicionHoldTest, OneThatExplainsMoreTakesItsPlaceAtOnce) {
  look(SuspicionKind::wiring, 3);
  look(SuspicionKind::doubled_id, 2);
  EXPECT_EQ(standing(), SuspicionKind::wiring);
  const SuspicionHold::Change change = look(SuspicionKind::doubled_id);
  EXPECT_FALSE(change.ended) << "nobody knows whether its reason is gone";
  EXPECT_EQ(change.displaced->kind, SuspicionKind::wiring);
  EXPECT_EQ(change.began->kind, SuspicionKind::doubled_id);
}

TEST_F(SuspicionHoldTest, OneThatExplainsLessWaits) {
  look(SuspicionKind::bit_rate, 3);
  look(SuspicionKind::wiring, 9);
  EXPECT_EQ(standing(), SuspicionKind::bit_rate);
  look(SuspicionKind::wiring);
  EXPECT_EQ(standing(), SuspicionKind::wiring);
  EXPECT_EQ(began_, 2);
  EXPECT_EQ(displaced_, 1);
  EXPECT_EQ(ended_, 0);
}

TEST_F(SuspicionHoldTest, KindsThatAlternateAreToldOnceAMinuteAndKeepTheirAge) {
  look(SuspicionKind::wiring, 3);
  const WallTime wiring_since = hold_.since();
  look(SuspicionKind::alone, 3);
  const WallTime alone_since = hold_.since();
  EXPECT_NE(alone_since, wiring_since);
  for (int i = 0; i < 10; ++i) {
    look(SuspicionKind::wiring, 12);
    EXPECT_EQ(standing(), SuspicionKind::wiring);
    EXPECT_EQ(hold_.since(), wiring_since);
    look(SuspicionKind::alone, 3);
    EXPECT_EQ(hold_.since(), alone_since);
  }
  EXPECT_EQ(began_, 2 + 2 + 2) << "150 s";
  EXPECT_EQ(began_, displaced_ + 1);
  look(std::nullopt, 60);
  EXPECT_EQ(ended_, 1);
  look(SuspicionKind::alone, 3);
  EXPECT_NE(hold_.since(), alone_since) << "it had ended";
}

TEST_F(SuspicionHoldTest, WhereThereIsNothingToLookAtItIsDropped) {
  look(SuspicionKind::wiring, 3);
  EXPECT_EQ(hold_.drop()->kind, SuspicionKind::wiring);
  EXPECT_FALSE(standing());
  EXPECT_FALSE(hold_.drop());
  look(SuspicionKind::wiring, 3);
  EXPECT_EQ(began_, 2);
}

TEST_F(SuspicionHoldTest, TheNewestWordsStand) {
  look(SuspicionKind::overload, 3);
  now_ += 1s;
  const auto change =
      hold_.look(Suspicion{.kind = SuspicionKind::overload, .seen = "load 97 %", .look = "there"}, now_, WallTime());
  EXPECT_FALSE(change.began);
  EXPECT_EQ(hold_.standing()->seen, "load 97 %");
  EXPECT_NE(hold_.since(), WallTime()) << "it began before";
}

}  // namespace
}  // namespace canopen
