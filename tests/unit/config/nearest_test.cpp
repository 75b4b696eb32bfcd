#include "config/nearest.h"

#include <gtest/gtest.h>

#include <array>
#include <string>

namespace config {
namespace {

constexpr std::array<std::string_view, 4> kNames{"heartbeat", "heartbeat_timeout", "node", "name"};

TEST(Nearest, FindsTheNameBehindATypingMistake) {
  EXPECT_EQ(nearest("hearbeat", kNames), "heartbeat");
  EXPECT_EQ(nearest("nodes", kNames), "node");
  EXPECT_EQ(nearest("nmae", kNames), "name");
  EXPECT_EQ(nearest("heartbeat_timout", kNames), "heartbeat_timeout");
}

TEST(Nearest, AlwaysNamesOneAndNoneOfNone) {
  EXPECT_FALSE(nearest("something else", kNames).empty());
  EXPECT_TRUE(nearest("x", {}).empty());
  EXPECT_FALSE(nearest(std::string(100'000, 'x'), kNames).empty());
}

}  // namespace
}  // namespace config
