#include "bridges/mqtt/backoff.h"

#include <gtest/gtest.h>

namespace mqtt {
namespace {

using namespace std::chrono_literals;

TEST(Backoff, DoublesUpToItsLongestWithBoundedJitter) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    Backoff backoff(1000ms, 30000ms, seed);
    auto whole = 1000ms;
    for (int i = 0; i < 100; ++i) {
      const auto pause = backoff.next();
      EXPECT_LE(pause, whole);
      EXPECT_GE(pause, whole / 2);
      whole = std::min(whole * 2, std::chrono::milliseconds(30000));
    }
    backoff.reset();
    EXPECT_LE(backoff.next(), 1000ms);
  }
}

TEST(Backoff, DiffersFromGatewayToGateway) {
  Backoff one(1000ms, 30000ms, 1);
  Backoff other(1000ms, 30000ms, 2);
  int same = 0;
  for (int i = 0; i < 10; ++i) {
    same += one.next() == other.next() ? 1 : 0;
  }
  EXPECT_LT(same, 10);
}

}  // namespace
}  // namespace mqtt
