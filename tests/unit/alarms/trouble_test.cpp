// What is told of a disk, and how often.

#include "bridges/disk/trouble.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

namespace disk {
namespace {

using namespace std::chrono_literals;

class TroubleTest : public testing::Test {
 protected:
  std::vector<std::string> told_;
  Trouble trouble_{[this](const std::string& text) { told_.push_back(text); }};
  const canopen::TimePoint start_{1h};
};

TEST_F(TroubleTest, IsToldOnceAndItsEnd) {
  trouble_.stands("full", start_);
  trouble_.stands("full", start_ + 2min);
  trouble_.is_over("well");
  trouble_.is_over("well");
  EXPECT_EQ(told_, (std::vector<std::string>{"full", "well"}));
}

TEST_F(TroubleTest, AnotherOneIsToldAtOnce) {
  trouble_.stands("full", start_);
  trouble_.stands("hangs", start_ + 1s);
  trouble_.is_over("well");
  trouble_.stands("read-only", start_ + 2s);
  EXPECT_EQ(told_, (std::vector<std::string>{"full", "hangs", "well", "read-only"}));
}

TEST_F(TroubleTest, TheSameIsToldOnceAMinute) {
  trouble_.stands("full", start_);
  trouble_.is_over("well");
  trouble_.stands("full", start_ + 59s);
  trouble_.is_over("well");
  EXPECT_EQ(told_.size(), 2U);
  trouble_.stands("full", start_ + 60s);
  EXPECT_EQ(told_.size(), 3U);
}

}  // namespace
}  // namespace disk
