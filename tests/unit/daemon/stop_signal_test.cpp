#include "daemon/stop_signal.h"

#include <gtest/gtest.h>

#include <csignal>

#include "tests/support/hand_driven_loop.h"
#include "tests/support/spawn.h"

namespace gateway {
namespace {

class StopSignalTest : public testing::Test {
 protected:
  support::HandDrivenLoop loop_;
  StopSignal stop_{loop_.executor()};
};

TEST_F(StopSignalTest, IsWaitedFor) {
  const auto done = support::spawn(loop_.executor(), stop_.wait());
  loop_.settle();
  EXPECT_FALSE(*done);
  std::raise(SIGTERM);
  loop_.settle();
  EXPECT_TRUE(*done);
}

TEST_F(StopSignalTest, MayComeBeforeAnybodyWaits) {
  std::raise(SIGINT);
  const auto done = support::spawn(loop_.executor(), stop_.wait());
  loop_.settle();
  EXPECT_TRUE(*done);
}

TEST_F(StopSignalTest, IsGivenByTheProgramItself) {
  const auto waiting = support::spawn(loop_.executor(), stop_.wait());
  loop_.settle();
  stop_.stop();
  loop_.settle();
  EXPECT_TRUE(*waiting);
  const auto later = support::spawn(loop_.executor(), stop_.wait());
  loop_.settle();
  EXPECT_TRUE(*later);
}

}  // namespace
}  // namespace gateway
