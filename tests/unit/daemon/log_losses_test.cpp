#include "daemon/log_losses.h"

#include <gmock/gmock.h>

#include <chrono>
#include <utility>
#include <vector>

#include "tests/support/hand_driven_loop.h"

namespace gateway {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

TEST(LogLosses, AreToldAtOnceAndThenEachMinute) {
  support::HandDrivenLoop loop;
  std::size_t dropped = 0;
  std::vector<std::pair<std::size_t, std::size_t>> told;
  const LogLosses losses(
      loop.executor(), [&dropped] { return dropped; },
      [&told](std::size_t lost, std::size_t all) { told.emplace_back(lost, all); });
  loop.advance(seconds(600), seconds(1));
  EXPECT_THAT(told, IsEmpty());
  dropped = 3;
  loop.advance(seconds(1), seconds(1));
  EXPECT_THAT(told, ElementsAre(Pair(3U, 3U)));
  for (int i = 0; i < 59; ++i) {
    ++dropped;
    loop.advance(seconds(1), seconds(1));
  }
  EXPECT_THAT(told, ElementsAre(Pair(3U, 3U)));
  loop.advance(seconds(1), seconds(1));
  EXPECT_THAT(told, ElementsAre(Pair(3U, 3U), Pair(59U, 62U)));
  loop.advance(seconds(600), seconds(1));
  EXPECT_EQ(told.size(), 2U) << "what was told is not told again";
}

}  // namespace
}  // namespace gateway
