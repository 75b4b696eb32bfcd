#include "bridges/mqtt/errand.h"

#include <gtest/gtest.h>

#include <future>
#include <new>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

constexpr auto kLimit = 20s;

TEST(Errand, TellsOnceWhatCameOfIt) {
  Errand<int> errand;
  ASSERT_TRUE(errand.start([] { return 7; }));
  EXPECT_EQ(errand.take(kLimit), 7);
  EXPECT_FALSE(errand.runs());
  EXPECT_EQ(errand.take(), std::nullopt);
}

TEST(Errand, WhatCameOfItLongAgoIsNotTold) {
  Errand<int> errand;
  std::promise<void> ended;
  ASSERT_TRUE(errand.start([&ended] {
    ended.set_value();
    return 7;
  }));
  ended.get_future().wait();
  errand.forget_older(1h);
  EXPECT_TRUE(errand.runs()) << "that is not long ago";
  while (errand.runs()) {
    errand.forget_older(-1ms);  // as soon as it has ended
  }
  ASSERT_TRUE(errand.start([] { return 8; }));
  EXPECT_EQ(errand.take(kLimit), 8);
}

TEST(Errand, WhatThrowsComesToNothing) {
  Errand<int> errand;
  ASSERT_TRUE(errand.start([]() -> int { throw std::bad_alloc(); }));
  EXPECT_EQ(errand.take(kLimit), 0);
  EXPECT_FALSE(errand.runs());
}

TEST(Errand, OneThatHangsCanBeForgottenAndAnotherOneBegun) {
  Errand<int> errand;
  std::promise<void> release;
  ASSERT_TRUE(errand.start([released = release.get_future().share()] {
    released.wait();
    return 7;
  }));
  errand.forget_older(-1ms);
  EXPECT_TRUE(errand.runs()) << "nothing came of it yet";
  errand.forget();
  ASSERT_TRUE(errand.start([] { return 8; }));
  EXPECT_EQ(errand.take(kLimit), 8);
  release.set_value();
}

}  // namespace
}  // namespace mqtt
